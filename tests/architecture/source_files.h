#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace windhover::test {

/// Every .h and .cc file of the source tree below `folder`, sorted; build products left out.
inline std::vector<std::filesystem::path> SourceFiles(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    const fs::path name = it->path().filename();
    if (it->is_directory() && (name == "build" || name.string().starts_with("."))) {
      it.disable_recursion_pending();
    }
    if (name.extension() == ".h" || name.extension() == ".cc") files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline std::vector<std::string> Lines(const std::filesystem::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace windhover::test
