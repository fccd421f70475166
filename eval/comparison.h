#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "eval/evaluation.h"

namespace windhover {

/// A metric of A and of B under common random numbers: means over pairs, and the mean of the
/// differences of pairs.
struct MetricDifference {
  std::string metric;  ///< Path in score.json.
  int n = 0;           ///< Pairs: of runs, or of frames.
  double a = 0, b = 0;
  std::optional<std::array<double, 2>> ci95;  ///< Of b - a.

  double Difference() const { return b - a; }
};

/// Every number of `methods` and `swarm` in score.json that both runs of at least one pair have,
/// in the order of the file. Intervals resample pairs; one pair has none.
/// @param a, b as many scores, those of one pair at the same place.
std::vector<MetricDifference> CompareScores(std::span<const nlohmann::ordered_json> a,
                                            std::span<const nlohmann::ordered_json> b);

/// `abs_rel` of each method that both runs have, over the frames in which both have an estimate
/// of the same target. Intervals resample blocks of at least 2 s (TimeBlocks).
std::vector<MetricDifference> CompareFrames(const Evaluation& a, const Evaluation& b);

/// Scenario keys whose values differ, as "key: value of A → value of B", in order of their lines.
std::vector<std::string> DifferentKeys(const Scenario& a, const Scenario& b);

/// By how much a metric may be worse.
struct AllowedLoss {
  std::string metric;
  double most = 0;  ///< At least 0.
};

/// A metric beside its baseline.
struct Regression {
  AllowedLoss allowed;
  std::optional<double> before, now;
  double loss = 0;  ///< Positive: worse (MoreIsBetter()).
  bool pass = false;
  std::string message;  ///< Why it fails; empty when it passes.
};

/// Holds a score against the stored one of another version. A metric that either lacks fails.
std::vector<Regression> FindRegressions(const nlohmann::ordered_json& baseline,
                                        const nlohmann::ordered_json& score,
                                        std::span<const AllowedLoss> allowed);

}  // namespace windhover
