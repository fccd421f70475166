#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "lcmtypes/uav_truth_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/propeller.h"
#include "render/row_poses.h"
#include "rig/exposure.h"
#include "rig/rig_motion.h"
#include "scenarios/scenario.h"

namespace windhover {

/// X_WB of `truth`, carried on for `dt_s` with its linear and angular velocity.
Eigen::Isometry3d PoseAt(const uav_truth_t& truth, double dt_s);

/// The rotors of `truth` during an exposure of `duration_s` about `middle_s` from its moment.
RotorTurning TurningOf(const uav_truth_t& truth, double middle_s, double duration_s);

/// What drives the rig of an observer during the tick that begins with `world`.
RigDrive DriveOf(const world_truth_t& world, std::size_t observer);

/// One moment of a mean over the exposure.
struct ExposureNode {
  double offset_s;      ///< From the middle of the exposure.
  std::uint32_t share;  ///< Of the mean, in 65536ths; they sum to 65536.
};

/// When the sub-exposures of a frame are taken.
struct ExposurePlan {
  /// Of the targets, whose outlines are sharp: the middles of equal parts of the exposure, from
  /// the middle of it; odd number, ascending.
  std::vector<double> offsets_s;
  /// Of the surroundings, which are as smooth as the lens leaves them: Gauss-Legendre nodes,
  /// ascending.
  std::vector<ExposureNode> background;
};

/// Gauss-Legendre nodes on an exposure that moves the image by `motion_px`: as many as keep the
/// blur's transfer function within 0.1 of the true one up to a quarter of a cycle a pixel, half
/// of what neighbouring texels can hold; at most five. With n of them any motion that is a
/// polynomial of time up to degree 2 n - 1 has its true mean.
/// Source: M. Abramowitz and I. Stegun, "Handbook of Mathematical Functions", table 25.4.
std::vector<ExposureNode> BackgroundNodes(double motion_px, double duration_s, int max_nodes);

/// Splits an exposure of `duration_s` so that no target moves more than max_blur_px in the image
/// within a part, by the turning of the cameras (aircraft, vibration, flex) and by its own motion;
/// the nodes of the surroundings follow from the turning alone. At most max_samples parts (one less
/// if that is even).
ExposurePlan PlanExposure(const ExposureConfig& config, double duration_s,
                          const world_truth_t& world, std::size_t observer, const RigMotion& rig,
                          double focal_px);

/// Rows between those for which a rolling shutter's cameras are known: those of a RayGrid.
inline constexpr int kRowStep_px = 16;

/// One camera in W while its rows are exposed: at rows 0, kRowStep_px, … up to beyond the last, or
/// once for all rows of a global shutter.
struct RowCameras {
  AnyCamera camera;
  std::vector<double> times_s;  ///< From the world's utime.
  std::vector<Eigen::Isometry3d> X_WC;
};

struct StereoRowCameras {
  RowCameras left, right;
};

/// Both cameras, each when its own shutter exposes each row, `offset_s` from the middle of the
/// row's exposure.
StereoRowCameras CamerasByRows(const world_truth_t& world, std::size_t observer,
                               const Eigen::Isometry3d& X_BR, const RigMotion& rig,
                               const StereoShutterTimes& shutter, int height_px, double offset_s);

/// The aircraft `target` as each row sees it.
RowPoses PosesOf(const RowCameras& cameras, const uav_truth_t& target);

}  // namespace windhover
