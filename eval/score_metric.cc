#include "eval/score_metric.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "common/config/config_node.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 15> kMoreIsBetter = {"n",
                                                            "detected",
                                                            "delta_1_25",
                                                            "coverage_95",
                                                            "min_separation_m",
                                                            "order",
                                                            "connectivity",
                                                            "algebraic_connectivity",
                                                            "union_by_sight",
                                                            "first_sight_to_near_miss_s",
                                                            "track_purity",
                                                            "received",
                                                            "targets_in_view",
                                                            "real_time_factor",
                                                            "stereo_pairs_per_s"};

std::string KeysOf(const Json& object) {
  std::string keys;
  for (const auto& [key, value] : object.items()) keys += (keys.empty() ? "" : ", ") + key;
  return keys;
}

/// The bin of a list by distance that begins at `from_m`; null if it has no frames.
const Json* BinFrom(const Json& bins, const std::string& from_m) {
  for (const Json& bin : bins) {
    if (bin.is_object() && bin.contains("from_m") &&
        fmt::format("{:g}", bin["from_m"].get<double>()) == from_m) {
      return &bin;
    }
  }
  return nullptr;
}

}  // namespace

FoundMetric FindMetric(const Json& score, const std::string& path) {
  const Json* at = &score;
  FoundMetric found;
  for (const std::string& key : SplitPath(path)) {
    if (at->is_array()) {
      at = BinFrom(*at, key);
      if (at != nullptr) continue;
      found.problem = fmt::format("there is nothing to judge: no frames from {} m on", key);
      return found;
    }
    if (!at->is_object() || !at->contains(key)) {
      found.problem = fmt::format("there is no metric '{}': no '{}'", path, key);
      if (at->is_object()) found.problem += fmt::format(" among {}", KeysOf(*at));
      return found;
    }
    if (at->contains("n") && (*at)["n"] == 0) {
      found.problem = "there is nothing to judge: n = 0";
      return found;
    }
    const auto intervals = at->find("ci95");
    found.interval = nullptr;
    if (intervals != at->end() && intervals->contains(key)) found.interval = &(*intervals)[key];
    at = &(*at)[key];
  }
  found.value = at;
  return found;
}

std::optional<double> NumberIn(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1 : 0;
  if (!value.is_number() || !std::isfinite(value.get<double>())) return std::nullopt;
  return value.get<double>();
}

bool MoreIsBetter(const std::string& path) {
  return std::find(kMoreIsBetter.begin(), kMoreIsBetter.end(), SplitPath(path).back()) !=
         kMoreIsBetter.end();
}

}  // namespace windhover
