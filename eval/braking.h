#pragma once

#include <Eigen/Core>

#include "lcmtypes/uav_truth_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/swarm_config.h"

namespace windhover {

/// Whether the rule of the collision guard (docs/swarm.md), given the true positions and
/// velocities of all others, seen or not, and no margin for uncertainty, forbids the velocity
/// `wish_W_mps`: some other aircraft would come within stop_m if both flew on, and from the wish
/// there is no stopping stop_m before it. Written apart from the guard's own code, which it judges.
bool MustBrake(const SwarmConfig& config, const uav_truth_t& self, const world_truth_t& tick,
               const Eigen::Vector3d& wish_W_mps);

}  // namespace windhover
