#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "scenarios/scenario.h"

namespace windhover {

/// One limit of the scenario's `expect`, and whether it holds.
struct GateResult {
  std::string name;    ///< "methods.baseline.abs_rel_all upper95"
  std::string metric;  ///< Path in score.json.
  std::string kind;    ///< max | min | upper95 | lower95
  double limit = 0;
  std::optional<double> value;  ///< What is held against the limit; nothing when there is none.
  bool pass = false;
  std::string message;  ///< Why it fails; empty when it passes.
};

/// Holds `score` (in the form of score.json) against every limit.
///
/// `max` and `min` look at the value and allow the limit itself; `upper95` and `lower95` look at
/// the end of the metric's 95 % interval. A metric that does not exist, has no value or no
/// interval, or is of a group with n = 0 fails: nothing passes for want of evidence.
std::vector<GateResult> EvaluateGates(const nlohmann::ordered_json& score,
                                      std::span<const Expectation> expectations);

}  // namespace windhover
