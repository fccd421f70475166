#pragma once

#include <span>

#include <Eigen/Geometry>

#include "swarm/flocking.h"

namespace windhover {

/// How fast to turn so that the rig at X_WR looks where `swarm.yaw` wants it. Where that names no
/// direction (no neighbours, no flight) it turns on at scan_radps, to find somebody.
///
/// kAttend looks at the neighbour that has been out of sight for longest beside its distance, and
/// at the middle of them while all are in view.
double YawRateFor(const SwarmConfig& config, std::span<const Neighbour> neighbours,
                  const Eigen::Vector3d& wish_mps, const Eigen::Isometry3d& X_WR);

}  // namespace windhover
