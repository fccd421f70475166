#pragma once

#include <optional>

#include <Eigen/Geometry>

#include "camera/any_camera.h"

namespace windhover {

/// A calibrated stereo rig: optical axes parallel, right camera displaced along +x by the
/// baseline. The rig frame R has its origin in the middle of the baseline and a camera's axes
/// (right, down, forward).
struct StereoRig {
  AnyCamera left, right;
  double baseline_m;  ///< > 0.
  int width_px, height_px;
};

/// A camera and where it is: X_RC maps camera coordinates to the rig frame.
struct PosedCamera {
  AnyCamera camera;
  Eigen::Isometry3d X_RC;

  /// Returns the pixel that sees a point of the rig frame, or nothing if none does.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_RQ_m) const;
};

struct PosedStereoRig {
  PosedCamera left, right;
};

/// The rig as its calibration says: parallel axes, half a baseline to each side.
PosedStereoRig Posed(const StereoRig& rig);

/// Where both cameras see one point.
struct StereoPixels {
  Eigen::Vector2d left_px, right_px;
};

/// The pixels that see the point `p_RQ_m`; the inverse of Triangulate when `rig` is Posed().
/// @return nothing if either camera does not see it. Image borders are not considered.
std::optional<StereoPixels> Project(const PosedStereoRig& rig, const Eigen::Vector3d& p_RQ_m);

/// A point triangulated in the rig frame R, with its uncertainty along the ray.
struct TriangulatedPoint {
  Eigen::Vector3d p_RT_m;
  double depth_m;  ///< p_RT z.
  double range_m;  ///< |p_RT|.
  double range_sigma_m;
};

/// Where rays through `left_px` and `right_px` meet: depth = f · baseline / d with the
/// disparity d = f (x_L - x_R) of undistorted image coordinates and f that of the left camera;
/// range = |p_RT|. Rays that pass each other vertically meet at the middle of both y.
///
/// The uncertainty is first order, sigma_Z = Z² / (f · baseline) · disparity_sigma_px, so it grows
/// with the square of distance. Source: D. Gallup et al., "Variable Baseline/Resolution
/// Stereo", CVPR 2008.
/// @return nothing where the disparity is not positive or a pixel has no ray.
std::optional<TriangulatedPoint> Triangulate(const StereoRig& rig, const Eigen::Vector2d& left_px,
                                             const Eigen::Vector2d& right_px,
                                             double disparity_sigma_px);

}  // namespace windhover
