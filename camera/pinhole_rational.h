#pragma once

#include <optional>

#include <Eigen/Core>

#include "camera/camera_model.h"
#include "camera/intrinsics.h"

namespace windhover {

/// A pinhole camera with OpenCV's rational (CALIB_RATIONAL_MODEL) and thin-prism
/// (CALIB_THIN_PRISM_MODEL) terms.
///
/// With (x, y) = (X, Y) / Z the undistorted image-plane point and s = r² = x² + y²,
///
///     q  = (1 + k1 s + k2 s² + k3 s³) / (1 + k4 s + k5 s² + k6 s³)
///     x' = x q + 2 p1 x y + p2 (s + 2 x²) + s1 s + s2 s²                 u = fx x' + cx
///     y' = y q + p1 (s + 2 y²) + 2 p2 x y + s3 s + s4 s²                 v = fy y' + cy
///
/// The model holds only where it is invertible: from the axis out to the radius at which r q stops
/// growing or its denominator vanishes. Beyond, points and pixels have no answer.
///
/// Source: D. Claus and A. Fitzgibbon, "A rational function lens distortion model", CVPR 2005; J.
/// Weng et al., "Camera calibration with distortion models and accuracy evaluation", PAMI 1992
/// (thin prism); the terms and their meaning are OpenCV's, against which tests compare.
class PinholeRational {
 public:
  /// Dimensionless, in OpenCV's order.
  struct Terms {
    double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0, k4 = 0, k5 = 0, k6 = 0;
    double s1 = 0, s2 = 0, s3 = 0, s4 = 0;
  };
  PinholeRational(const Intrinsics& intrinsics, const Terms& terms);

  double fx_px, fy_px;  ///< Focal lengths, > 0.
  double cx_px, cy_px;  ///< Principal point.
  const Terms& DistortionTerms() const { return terms_; }

  /// Returns the pixel that sees the point Q, or nothing if Q's depth is below kMinDepth_m or
  /// Q is outside the invertible region. If `dq_dp` is not null, also writes the derivative there.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_CQ_m,
                                         PixelFromPointJacobian* dq_dp = nullptr) const;

  /// Returns the unit direction in C seen by `q_px`, by Newton iteration to 1e-9 px at
  /// f = 10⁴ px; nothing if no direction of the invertible region is seen there.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& q_px) const;

  static constexpr double kMinDepth_m = 1e-6;

 private:
  Terms terms_;
  double largest_r2_;  ///< The model is invertible below.
};

static_assert(CameraModel<PinholeRational>);

}  // namespace windhover
