#pragma once

#include <optional>
#include <span>

#include "eval/run_record.h"

namespace windhover {

/// How the aircraft kept apart and together; nothing where there are fewer than two.
struct SwarmMetrics {
  std::optional<double> min_separation_m;  ///< Smallest distance of any two, at any tick.
  /// How often a pair came closer than score.collision_m, or score.near_miss_m; a pair that
  /// stays close counts once.
  std::optional<int> collisions, near_misses;
  /// Alignment of velocities, mean over ticks of |mean of v / |v||, 1 when all fly one way.
  /// Aircraft slower than 0.1 m/s have no direction. Source: T. Vicsek et al., PRL 75, 1995.
  std::optional<double> order;
  /// Mean over frames of the share of aircraft in the largest group that is linked by sight: a
  /// link is a target in view of both cameras of an aircraft.
  std::optional<double> connectivity;
  /// Mean over frames of λ₂ / N of the Laplacian of those links, 0 where the aircraft fall into
  /// more than one group, 1 where all see all. Source: M. Fiedler, Czech. Math. J. 23, 1973.
  std::optional<double> algebraic_connectivity;
  /// Mean over frames of (N - groups) / (N - 1): 1 when all are linked, 0 when no one is.
  /// Source: E. Soria et al., "SwarmLab", IROS 2020.
  std::optional<double> union_by_sight;
  /// Least of all pairs of an aircraft and a target that it detects, at the first detection: time
  /// until they are score.near_miss_m apart if both keep their velocity. Nothing: none would be.
  std::optional<double> first_sight_to_near_miss_s;
  /// Share of all tracked detections that are of the target which their track shows most often.
  std::optional<double> track_purity;
};

SwarmMetrics ComputeSwarmMetrics(std::span<const world_truth_t> world,
                                 std::span<const ObserverFrame> frames, const ScoreConfig& score);

}  // namespace windhover
