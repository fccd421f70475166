#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/config_node.h"

namespace windhover {

/// Parses one YAML document. Text that is hostile (deep nesting, aliases that multiply, a file
/// of gigabytes) ends in a ConfigError, not in a crash.
/// @throws ConfigError `name:line:column: must be …` at the first syntax error.
ConfigNode ParseYaml(const std::string& text, const ConfigSource& source);

/// Reads a YAML file. A top-level `extends: other.yaml` (relative to the file that has it)
/// takes everything from that file first; chains are allowed, circles are errors.
/// @throws ConfigError if a file cannot be read or is not YAML.
ConfigNode LoadConfigTree(const std::filesystem::path& file);

/// Puts `value` at a dotted path, which is written at `where`; a list index is a number. Maps on
/// the way are made, and a map merges into the one that is there.
/// @throws ConfigError if the path leads through a value, or to an item that a list does not have.
void SetNode(ConfigNode& root, const std::string& path, const SourceLocation& where,
             const ConfigNode& value);

/// Takes the value of a top-level key out of a tree; nothing if it is not there.
ConfigNode TakeNode(ConfigNode& root, const std::string& key);

/// Applies `--set a.b.c=value`, where `value` is YAML and a list index is a number. Messages
/// call the place `--set:ORDINAL:COLUMN`; relative input files are taken from the current folder.
/// @throws ConfigError if `assignment` has no `=`, or names an item a list does not have.
void ApplyOverride(ConfigNode& root, const std::string& assignment, int ordinal);

}  // namespace windhover
