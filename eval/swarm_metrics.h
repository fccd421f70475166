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
};

SwarmMetrics ComputeSwarmMetrics(std::span<const world_truth_t> world,
                                 std::span<const ObserverFrame> frames, const ScoreConfig& score);

}  // namespace windhover
