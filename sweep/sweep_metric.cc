#include "sweep/sweep_metric.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/config/config_node.h"
#include "eval/evaluation.h"

namespace windhover {

using Json = nlohmann::ordered_json;

std::vector<std::string> UsualMetrics(const Scenario& scenario) {
  std::vector<std::string> metrics;
  for (const std::string& method : scenario.estimator.methods) {
    for (const char* metric : {"abs_rel_all", "abs_rel", "bias_m"}) {
      metrics.push_back(fmt::format("methods.{}.{}", method, metric));
    }
  }
  metrics.emplace_back("frames.targets_in_view");
  if (scenario.aircraft.size() > 1) {
    for (const char* metric : {"min_separation_m", "collisions", "near_misses"}) {
      metrics.push_back(fmt::format("swarm.{}", metric));
    }
  }
  return metrics;
}

std::string WhyNoMetric(const Scenario& scenario, const std::string& path) {
  // The score of a flight that has not begun has every key.
  RunRecord run;
  run.scenario = scenario;
  const Json score = EvaluateRecord(std::move(run)).score;
  const Json* at = &score;
  bool is_bin = false;
  for (const std::string& key : SplitPath(path)) {
    if (at->is_array()) {  // Distances; every bin has what lt20 has.
      if (is_bin || key.empty() || key.find_first_not_of("0123456789") != std::string::npos) {
        return fmt::format("no distance '{}'", key);
      }
      at = &score["methods"].front()["lt20"];
      is_bin = true;
      continue;
    }
    if (!at->is_object() || !at->contains(key)) return fmt::format("no '{}'", key);
    at = &(*at)[key];
  }
  return at->is_object() || at->is_array() || at->is_string() ? "a group, not a number" : "";
}

}  // namespace windhover
