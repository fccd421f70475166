#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/time/sim_time.h"
#include "eval/bootstrap.h"

namespace windhover {

/// One term of a method's score: a target in view, and what the method said of it.
struct ScoredFrame {
  Utime utime = 0;
  double reference_m = 0;            ///< d* > 0.
  std::optional<double> estimate_m;  ///< d; nothing: no estimate.
  double sigma_m = 0;                ///< Of the estimate; not positive: none was given.
};

/// Means over the frames of one group (all, a distance bin, < 20 m, …). With e = d - d*:
///
///     abs_rel = mean |e| / d*        sq_rel = mean e² / d*        rmse_m = sqrt(mean e²)
///     bias_m = mean e                delta_1_25 = share with max(d / d*, d* / d) < 1.25
///     nees = mean e² / sigma²        coverage_95 = share with |e| <= 1.96 sigma
///
/// over frames with an estimate; abs_rel_all is abs_rel over every frame, where one without an
/// estimate is an error of 1. Sources: D. Eigen et al., NIPS 2014 (abs_rel, sq_rel, delta);
/// Y. Bar-Shalom et al., "Estimation with Applications to Tracking and Navigation", 5.4.2 (nees).
struct ErrorMetrics {
  int n = 0;         ///< Frames.
  int detected = 0;  ///< Frames with an estimate.
  std::optional<double> abs_rel_all, abs_rel, sq_rel, rmse_m, bias_m, delta_1_25, nees, coverage_95;
  /// 95 % intervals of abs_rel_all, abs_rel, sq_rel, bias_m; those that can be had.
  std::map<std::string, std::array<double, 2>> ci95;
};

/// Metrics of `frames`, with intervals from `blocks`.
ErrorMetrics ComputeErrorMetrics(std::span<const ScoredFrame> frames, const TimeBlocks& blocks,
                                 std::uint64_t seed);

struct DistanceBin {
  double from_m, to_m;
  ErrorMetrics metrics;
};

struct MethodScore {
  std::string method;
  ErrorMetrics all;
  std::vector<DistanceBin> by_distance;  ///< Bins of 5 m that have frames.
  ErrorMetrics lt20, gt20;               ///< d* < 20 m, and the rest.
  ErrorMetrics shared;                   ///< Frames for which every method has an estimate.
};

/// Scores of each method; `frames[m]` are those of `methods[m]`, the same frames in the same
/// order for all.
std::vector<MethodScore> ScoreMethods(const std::vector<std::string>& methods,
                                      const std::vector<std::vector<ScoredFrame>>& frames,
                                      double frame_period_s, std::uint64_t seed);

/// Middle value (mean of the two middle ones); nothing of nothing.
std::optional<double> Median(std::vector<double> values);

inline constexpr double kMinBlock_s = 2;
inline constexpr double kDistanceBin_m = 5;
inline constexpr double kNearFar_m = 20;

}  // namespace windhover
