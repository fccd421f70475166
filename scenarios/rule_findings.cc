#include "scenarios/rule_findings.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

namespace windhover {

void RuleFindings::MustBe(const std::string& path, const std::string& must,
                          const std::string& found, const std::vector<std::string>& uses) {
  const auto is_wrong = [&](const std::string& used) { return findings_.Mention(used); };
  if (is_wrong(path) || std::any_of(uses.begin(), uses.end(), is_wrong)) return;
  findings_.MustBe(NearestNode(root_, path).where, path, must, found);
}

void RuleFindings::CheckFile(const std::string& path, const InputFile& file, bool is_needed,
                             const std::string& reason, const std::string& reason_path) {
  if (file.empty()) {
    if (is_needed) MustBe(path, "the name of a file " + reason, "nothing", {reason_path});
    return;
  }
  if (files_ == InputFiles::kNotNeeded) return;
  std::error_code error;
  const bool is_readable = std::filesystem::is_regular_file(file.absolute, error) &&
                           access(file.absolute.c_str(), R_OK) == 0;
  if (!is_readable) MustBe(path, "a file that can be read", fmt::format("'{}'", file.absolute));
}

}  // namespace windhover
