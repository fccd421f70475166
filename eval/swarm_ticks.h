#pragma once

#include <optional>
#include <vector>

#include "eval/run_record.h"

namespace windhover {

/// Commands of one tick to aircraft that fly by swarm.controller with the guard enabled.
struct BrakingCounts {
  int commands = 0;
  int guarded = 0;        ///< The guard overruled the law.
  int false_brakes = 0;   ///< It did, without need (MustBrake()).
  int missed_brakes = 0;  ///< It did not, with need.
};

/// How the aircraft were to each other at one tick; nothing where there are fewer than two, or none
/// of what is counted.
struct SwarmTick {
  Utime utime = 0;
  std::optional<double> separation_m;  ///< Least distance of any two.
  /// |mean of v / |v||, 1 when all fly one way. Aircraft slower than 0.1 m/s have no direction.
  /// Source: T. Vicsek et al., PRL 75, 1995.
  std::optional<double> order;
  /// Share of aircraft in the largest group that is linked by sight: a link is a target in view of
  /// both cameras of an aircraft.
  std::optional<double> connectivity;
  /// λ₂ / N of the Laplacian of those links, 0 where the aircraft fall into more than one group, 1
  /// where all see all. Source: M. Fiedler, Czech. Math. J. 23, 1973.
  std::optional<double> algebraic_connectivity;
  /// (N - groups) / (N - 1): 1 when all are linked, 0 when no one is. Source: E. Soria et al.,
  /// "SwarmLab", IROS 2020.
  std::optional<double> union_by_sight;
  BrakingCounts braking;
};

/// One for each tick of the flight.
std::vector<SwarmTick> SwarmTicks(const RunRecord& run);

}  // namespace windhover
