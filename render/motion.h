#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "lcmtypes/uav_truth_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "rig/rig_motion.h"
#include "scenarios/scenario.h"

namespace windhover {

/// X_WB of `truth`, carried on for `dt_s` with its linear and angular velocity.
Eigen::Isometry3d PoseAt(const uav_truth_t& truth, double dt_s);

/// When the sub-exposures of a frame are taken: the middles of equal parts of the exposure.
struct ExposurePlan {
  std::vector<double> offsets_s;  ///< From the middle of the exposure; odd number, ascending.
};

/// Splits an exposure so that nothing in the image moves more than max_blur_px within a part:
/// the far background by the turning of the cameras (aircraft, vibration, flex), the nearest
/// target by its own motion. At most max_samples parts (one less if that is even).
ExposurePlan PlanExposure(const ExposureConfig& config, const world_truth_t& world,
                          std::size_t observer, const RigMotion& rig, double focal_px);

/// Both cameras of an observer's true rig in W.
struct WorldCameras {
  PinholeRadtan left, right;
  Eigen::Isometry3d X_WL, X_WR;
};

/// At `dt_s` from the world's utime.
WorldCameras CamerasAt(const world_truth_t& world, std::size_t observer,
                       const Eigen::Isometry3d& X_BR, const RigMotion& rig, double dt_s);

}  // namespace windhover
