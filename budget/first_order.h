#pragma once

#include <span>

#include <Eigen/Core>

namespace windhover {

/// A target as a stereo rig sees it: the place at which errors are propagated.
struct Sight {
  double focal_px;
  double baseline_m;
  double depth_m;                                   ///< Z > 0.
  double x = 0, y = 0;                              ///< Undistorted image plane of the left camera.
  Eigen::Vector3d v_mps = Eigen::Vector3d::Zero();  ///< Of the target in the rig's axes.

  double x_right() const { return x - baseline_m / depth_m; }
  double disparity_px() const { return focal_px * baseline_m / depth_m; }
};

/// How an error of depth grows with depth for a target at a fixed bearing, to leading order.
enum class DistanceLaw { kNone, kConstant, kLinear, kSquare };

/// "const", "Z", "Z^2" or "0".
const char* NameOf(DistanceLaw law);

/// What can be wrong with a rig; the unit follows.
enum class Disturbance {
  kRightYaw,         ///< rad, about the camera's own y axis.
  kRightPitch,       ///< rad, x axis.
  kRightRoll,        ///< rad, z axis.
  kLeftYaw,          ///< rad.
  kLeftPitch,        ///< rad.
  kLeftRoll,         ///< rad.
  kRelativeYaw,      ///< rad, right minus left, half to each camera.
  kRelativePitch,    ///< rad.
  kRelativeRoll,     ///< rad.
  kBaseline,         ///< m that the right camera is further right than calibrated.
  kRightDown,        ///< m.
  kRightForward,     ///< m.
  kRightFocal,       ///< px that the focal length is longer than calibrated.
  kLeftFocal,        ///< px.
  kFocal,            ///< px, of both.
  kRightCx,          ///< px that the principal point is further right.
  kLeftCx,           ///< px.
  kOffset,           ///< px, c_x of the left camera minus that of the right.
  kRightK1,          ///< More than calibrated.
  kLeftK1,           ///< Likewise.
  kK1,               ///< Of both.
  kRightP1,          ///< Of the right camera.
  kRightP2,          ///< Of the right camera.
  kAssumedFocal,     ///< px that the calibration says too much, of both cameras.
  kAssumedBaseline,  ///< m that the calibration says too much.
  kSkew,             ///< s that the right camera exposes later.
};

/// One row of the first-order table: an error of disparity per unit of a disturbance. For what a
/// calibration assumes it is the error of disparity that would do the same to the depth.
struct FirstOrderRow {
  Disturbance disturbance;
  const char* name;
  const char* unit;
  DistanceLaw law;
  double (*disparity_px)(const Sight& at);
};

/// All of them, in the order of Disturbance.
std::span<const FirstOrderRow> FirstOrderTable();
const FirstOrderRow& RowOf(Disturbance disturbance);

/// Error of depth for an error of disparity: -Z² / (f B) · error. Source: D. Gallup et al.,
/// "Variable Baseline/Resolution Stereo", CVPR 2008.
double DepthError_m(const Sight& at, double disparity_error_px);

/// To first order, what `amount` of a disturbance does to the depth that the calibration
/// triangulates.
double DepthError_m(Disturbance disturbance, const Sight& at, double amount);

/// Standard deviation of a disparity whose ends err by `left_px` and `right_px` with the given
/// correlation.
double DisparitySigma_px(double left_px, double right_px, double correlation);

/// Mean error of depth by noise of disparity, as depth goes with its inverse:
/// Z (σ_d / d)², the second-order term.
double InverseDisparityBias_m(const Sight& at, double disparity_sigma_px);

/// How far below its epipolar line the right camera sees the target when it is turned by
/// `turn_rad` (rotation vector in its own axes) and shifted by `shift_m`: to first order all that
/// a single pair of images shows of a rig that is out of order.
double EpipolarResidual_px(const Sight& at, const Eigen::Vector3d& turn_rad,
                           const Eigen::Vector3d& shift_m);

}  // namespace windhover
