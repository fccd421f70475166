#include "common/config/config_reader.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace windhover {
namespace {

// Number of single-character edits between two words; used for "did you mean".
std::size_t EditDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = std::exchange(row[j], std::min({row[j] + 1, row[j - 1] + 1, substitute}));
    }
  }
  return row.back();
}

std::string KnownKey(const std::string& key, const std::vector<std::string>& known) {
  constexpr std::size_t kLongestKey = 64;
  if (key.size() > kLongestKey) return "a known key";
  const auto nearest = std::min_element(known.begin(), known.end(), [&](auto& a, auto& b) {
    return EditDistance(key, a) < EditDistance(key, b);
  });
  const std::size_t tolerance = std::max<std::size_t>(1, key.size() / 3);
  if (nearest == known.end() || EditDistance(key, *nearest) > tolerance) return "a known key";
  return fmt::format("a known key; did you mean '{}'?", *nearest);
}

}  // namespace

const ConfigNode* ConfigReader::Take(const char* key) {
  known_keys_.emplace_back(key);
  return node_.Find(key);
}

void ConfigReader::ReportOtherKeys() {
  std::map<std::string, const SourceLocation*> seen;
  for (const ConfigNode::Entry& entry : node_.entries) {
    const auto [first, is_new] = seen.emplace(entry.key, &entry.where);
    if (!is_new) {
      findings_.MustBe(entry.where, Join(entry.key), "given once",
                       fmt::format("again, after {}", first->second->ToString()));
    } else if (std::count(known_keys_.begin(), known_keys_.end(), entry.key) == 0) {
      findings_.MustBe(entry.where, Join(entry.key), KnownKey(entry.key, known_keys_),
                       fmt::format("'{}'", entry.key.substr(0, 80)));
    }
  }
}

}  // namespace windhover
