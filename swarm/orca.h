#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "swarm/flocking.h"
#include "swarm/safe_velocity.h"

namespace windhover {

/// What one neighbour allows, if it takes its half of the change: J. van den Berg et al.,
/// "Reciprocal n-body collision avoidance", ISRR 2011, in three dimensions. Neighbours that
/// already touch must come apart within `step_s`.
SafeHalfSpace SafeVelocities(const OrcaConfig& config, const Neighbour& neighbour,
                             const Eigen::Vector3d& v_mps, double step_s);

/// The `n` nearest, nearest first.
std::vector<Neighbour> Nearest(std::span<const Neighbour> neighbours, int n);

/// The safe velocity nearest to the preferred one, among what the nearest max_neighbours allow.
Eigen::Vector3d OrcaVelocity(const OrcaConfig& config, std::span<const Neighbour> neighbours,
                             const Eigen::Vector3d& v_mps, const Eigen::Vector3d& preferred_mps,
                             double max_speed_mps, double step_s);

}  // namespace windhover
