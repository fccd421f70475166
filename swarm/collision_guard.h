#pragma once

#include <span>

#include <Eigen/Core>

#include "swarm/flocking.h"

namespace windhover {

/// The largest speed towards `neighbour` from which an aircraft can still stop stop_m before it;
/// negative where it must back off.
///
/// The gap is its distance less k sigmas, stop_m, and what is closed before braking begins. One's
/// own stopping distance may take that gap and the neighbour's stopping distance, which counts
/// against it while it comes nearer: two that meet have half of the gap each. Source: the safe
/// speed of P. G. Gipps, Transportation Research B 15(2), 1981, with oncoming traffic.
double SafeClosingSpeed(const GuardConfig& config, const Neighbour& neighbour,
                        const Eigen::Vector3d& v_mps, double max_speed_mps);

/// The velocity nearest to a law's wish that is slow enough towards every neighbour in its way: one
/// that would come within stop_m and k sigmas if the wish were flown and it flew on.
struct GuardedVelocity {
  Eigen::Vector3d v_mps;
  bool is_guarded;  ///< Whether it is not what was wished.
};
GuardedVelocity Guarded(const GuardConfig& config, std::span<const Neighbour> neighbours,
                        const Eigen::Vector3d& v_mps, const Eigen::Vector3d& wish_mps,
                        double max_speed_mps);

}  // namespace windhover
