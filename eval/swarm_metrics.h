#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "eval/run_record.h"
#include "eval/swarm_ticks.h"

namespace windhover {

/// How the aircraft kept apart and together; nothing where there are fewer than two.
struct SwarmMetrics {
  std::optional<double> min_separation_m;  ///< Smallest distance of any two, at any tick.
  /// How often a pair came closer than score.collision_m, or score.near_miss_m; a pair that
  /// stays close counts once.
  std::optional<int> collisions, near_misses;
  /// Means over the ticks that have them (SwarmTick).
  std::optional<double> order, connectivity, algebraic_connectivity, union_by_sight;
  /// Shares of the commands to aircraft that fly by swarm.controller (BrakingCounts); nothing
  /// without guard.
  std::optional<double> guarded, false_brakes, missed_brakes;
  /// Least of all pairs of an aircraft and a target that it detects, at the first detection: time
  /// until they are score.near_miss_m apart if both keep their velocity. Nothing: none would be.
  std::optional<double> first_sight_to_near_miss_s;
  /// Share of all tracked detections that are of the target which their track shows most often.
  std::optional<double> track_purity;
  /// 95 % intervals of means and shares over ticks, from blocks of at least 2 s; those that can be
  /// had.
  std::map<std::string, std::array<double, 2>> ci95;
};

/// @param ticks SwarmTicks() of `run`.
SwarmMetrics ComputeSwarmMetrics(const RunRecord& run, std::span<const SwarmTick> ticks);

}  // namespace windhover
