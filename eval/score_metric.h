#pragma once

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace windhover {

/// Where a metric's path ("methods.fused.abs_rel") leads in score.json, or why it leads nowhere.
struct FoundMetric {
  const nlohmann::ordered_json* value = nullptr;
  const nlohmann::ordered_json* interval = nullptr;  ///< Of 95 %; null: it has none.
  std::string problem;                               ///< Empty: found.
};

/// A group with n = 0 has no metrics. A bin by distance goes by where it begins:
/// "methods.fused.by_distance.25.abs_rel" is of 25 to 30 m.
FoundMetric FindMetric(const nlohmann::ordered_json& score, const std::string& path);

/// A finite number, or true and false as 1 and 0.
std::optional<double> NumberIn(const nlohmann::ordered_json& value);

/// Whether more of a metric is better, as of `detected`; of most, such as errors, less is.
bool MoreIsBetter(const std::string& path);

}  // namespace windhover
