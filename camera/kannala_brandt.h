#pragma once

#include <optional>

#include <Eigen/Core>

#include "camera/camera_model.h"
#include "camera/intrinsics.h"

namespace windhover {

/// A camera whose image radius depends on the angle from the axis: equidistant with four terms.
/// Kalibr calls it "equidistant", OpenCV "fisheye".
///
/// With r = √(X² + Y²) and θ = atan2(r, Z),
///
///     θ' = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)        (u, v) = (fx, fy) · θ' (X, Y) / r + (cx,
///     cy)
///
/// The model holds from the axis out to the angle at which θ' stops growing, and in front of the
/// lens (θ < 90°). Beyond, points and pixels have no answer.
///
/// Source: J. Kannala and S. Brandt, "A generic camera model and calibration method for
/// conventional, wide-angle, and fish-eye lenses", PAMI 2006; terms as in OpenCV's cv::fisheye,
/// against which tests compare.
class KannalaBrandt {
 public:
  struct Terms {
    double k1 = 0, k2 = 0, k3 = 0, k4 = 0;  ///< Dimensionless.
  };
  KannalaBrandt(const Intrinsics& intrinsics, const Terms& terms);

  double fx_px, fy_px;  ///< Focal lengths, > 0.
  double cx_px, cy_px;  ///< Principal point.
  const Terms& DistortionTerms() const { return terms_; }

  /// Returns the pixel that sees the point Q, or nothing if Q's depth is below kMinDepth_m or
  /// Q is outside the invertible region. If `dq_dp` is not null, also writes the derivative there.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& p_CQ_m,
                                         PixelFromPointJacobian* dq_dp = nullptr) const;

  /// Returns the unit direction in C seen by `q_px`, by Newton iteration to rounding; nothing if
  /// no direction of the invertible region is seen there.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& q_px) const;

  static constexpr double kMinDepth_m = 1e-6;

 private:
  Terms terms_;
  double largest_angle_rad_, largest_distorted_;
};

static_assert(CameraModel<KannalaBrandt>);

}  // namespace windhover
