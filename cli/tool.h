#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace windhover {

/// Where `name` is in PATH; empty if nowhere.
std::filesystem::path FindTool(const std::string& name);

/// The program `name` in the folder of this one.
std::filesystem::path OwnProgram(const std::string& name);

/// Runs a program to its end; `words[0]` is looked up in PATH if it has no slash.
/// @return its exit status; 127 if it cannot be started, 128 + signal if it was killed.
int RunTool(const std::vector<std::string>& words, bool silent = false);

/// Becomes the program `words[0]`. Returns only if it cannot be started.
void BecomeTool(std::vector<std::string> words);

/// Names of those of `packages` that Debian's package manager has not installed.
std::vector<std::string> MissingPackages(const std::vector<std::string>& packages);

}  // namespace windhover
