#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "swarm/flocking.h"

namespace windhover {

/// Velocities v with normal · v >= offset are safe.
struct SafeHalfSpace {
  Eigen::Vector3d normal;  ///< Unit.
  double offset_mps;
};

/// What one neighbour allows, if it takes its half of the change: J. van den Berg et al.,
/// "Reciprocal n-body collision avoidance", ISRR 2011, in three dimensions. Neighbours that
/// already touch must come apart within `step_s`.
SafeHalfSpace SafeVelocities(const OrcaConfig& config, const Neighbour& neighbour,
                             const Eigen::Vector3d& v_mps, double step_s);

/// The safe velocity nearest to `preferred_mps`, no faster than max_speed_mps; where no velocity is
/// safe, that which breaks the worst half-space least. Found among the points where up to three
/// half-spaces' borders, and the sphere of the fastest velocities, meet.
Eigen::Vector3d NearestSafeVelocity(std::span<const SafeHalfSpace> safe, double max_speed_mps,
                                    const Eigen::Vector3d& preferred_mps);

/// Both for all neighbours.
Eigen::Vector3d OrcaVelocity(const OrcaConfig& config, std::span<const Neighbour> neighbours,
                             const Eigen::Vector3d& v_mps, const Eigen::Vector3d& preferred_mps,
                             double max_speed_mps, double step_s);

}  // namespace windhover
