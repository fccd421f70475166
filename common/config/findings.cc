#include "common/config/findings.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "common/config/fields.h"

namespace windhover {

void Findings::MustBe(const SourceLocation& where, const std::string& path, const std::string& must,
                      const std::string& found) {
  Must(where, path, "be " + must, found);
}

void Findings::Must(const SourceLocation& where, const std::string& path, const std::string& must,
                    const std::string& found) {
  findings_.push_back(
      {where, path,
       fmt::format("{}: {}: must {} (found {})", where.ToString(), path, must, found)});
}

bool Findings::Mention(const std::string& path) const {
  return std::any_of(findings_.begin(), findings_.end(), [&](const Finding& finding) {
    return finding.path == path || finding.path.starts_with(path + ".");
  });
}

void Findings::ThrowIfAny() const {
  if (findings_.empty()) return;
  std::vector<Finding> sorted = findings_;
  const auto place = [](const Finding& finding) {
    const SourceLocation& where = finding.where;
    return std::tuple(where.source ? where.source->name : "", where.line, where.column);
  };
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const Finding& a, const Finding& b) { return place(a) < place(b); });
  std::string text;
  for (const Finding& finding : sorted) text += (text.empty() ? "" : "\n") + finding.text;
  throw ConfigError(text);
}

}  // namespace windhover
