#include "eval/gates.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "eval/score_metric.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

GateResult Judge(const Json& score, const std::string& metric, const std::string& kind,
                 double limit) {
  GateResult gate{.name = metric + " " + kind,
                  .metric = metric,
                  .kind = kind,
                  .limit = limit,
                  .value = {},
                  .pass = false,
                  .message = {}};
  const FoundMetric found = FindMetric(score, metric);
  const bool on_interval = kind == "upper95" || kind == "lower95";
  if (!found.problem.empty()) {
    gate.message = found.problem;
  } else if (on_interval && found.interval == nullptr) {
    gate.message = "the metric has no 95 % interval (the run is too short, or it never has one)";
  } else if (on_interval) {
    gate.value = NumberIn((*found.interval)[kind == "upper95" ? 1 : 0]);
  } else {
    gate.value = NumberIn(*found.value);
  }
  if (!gate.message.empty()) return gate;
  if (!gate.value) {
    gate.message = found.value->is_structured() ? "the path names a group, not a number"
                                                : "the metric has no value in this run";
    return gate;
  }
  const bool from_above = kind == "max" || kind == "upper95";
  gate.pass = from_above ? *gate.value <= limit : *gate.value >= limit;
  if (!gate.pass) {
    gate.message = fmt::format("{:.6g} must be {} {:.6g}", *gate.value,
                               from_above ? "at most" : "at least", limit);
  }
  return gate;
}

}  // namespace

std::vector<GateResult> EvaluateGates(const Json& score,
                                      std::span<const Expectation> expectations) {
  std::vector<GateResult> gates;
  for (const Expectation& expect : expectations) {
    const std::pair<const char*, double> limits[] = {{"max", expect.max},
                                                     {"min", expect.min},
                                                     {"upper95", expect.upper95},
                                                     {"lower95", expect.lower95}};
    const std::size_t n_before = gates.size();
    for (const auto& [kind, limit] : limits) {
      if (!std::isnan(limit)) gates.push_back(Judge(score, expect.metric, kind, limit));
    }
    if (gates.size() > n_before) continue;
    gates.push_back({.name = expect.metric,
                     .metric = expect.metric,
                     .kind = "none",
                     .limit = kUnset,
                     .value = {},
                     .pass = false,
                     .message = "the gate has no limit: give max, min, upper95 or lower95"});
  }
  return gates;
}

}  // namespace windhover
