#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace windhover {

/// Where configuration text comes from: a file, or one `--set` option.
struct ConfigSource {
  std::string name;              ///< As shown in messages.
  std::filesystem::path folder;  ///< Relative input files are taken from here.
};

/// A place in configuration text.
struct SourceLocation {
  std::shared_ptr<const ConfigSource> source;
  int line = 1, column = 1;

  std::string ToString() const;  ///< "file:line:column".
};

/// One YAML value that knows where it was written, so that values merged from several files
/// (`extends`, `--set`) are still reported at their own place.
struct ConfigNode {
  enum class Kind { kNothing, kScalar, kMap, kList };
  struct Entry;

  Kind kind = Kind::kNothing;
  SourceLocation where;
  std::string scalar;
  bool quoted = false;         ///< A quoted scalar is text, never a number.
  std::vector<Entry> entries;  ///< Of a map, in the order written; keys may still be repeated.
  std::vector<ConfigNode> items;

  bool IsScalar() const { return kind == Kind::kScalar; }
  bool IsMap() const { return kind == Kind::kMap; }
  bool IsList() const { return kind == Kind::kList; }

  /// The value of `key` in a map (the first one, if repeated), or null.
  const ConfigNode* Find(const std::string& key) const;
  ConfigNode* Find(const std::string& key);

  /// What stands here, for messages: "'12'", "a list", "a map", "nothing".
  std::string Found() const;
};

struct ConfigNode::Entry {
  std::string key;
  SourceLocation where;  ///< Of the key.
  ConfigNode value;
};

/// The node at `path` ("aircraft.1.trajectory.file"), or the deepest one on the way to it.
const ConfigNode& NearestNode(const ConfigNode& root, const std::string& path);

/// Parts of a dotted path.
std::vector<std::string> SplitPath(const std::string& path);

/// Maps merge key by key, everything else in `over` replaces what is in `base`.
void MergeInto(ConfigNode& base, const ConfigNode& over);

}  // namespace windhover
