#pragma once

#include <Eigen/Core>

#include "common/time/sim_time.h"

namespace windhover {

/// Learns how the cameras of a rig are pitched and rolled against each other from the heights at
/// which both see the same targets:
///
///     f (y_L - y_R) = offset + f · roll · x + noise        x: mean horizontal image coordinate
///
/// A Kalman filter over (offset, roll), both walking randomly. The offset is -f times the relative
/// pitch (right minus left), or that of the principal points; the two look the same.
class VerticalAlignment {
 public:
  explicit VerticalAlignment(double focal_px) : focal_px_(focal_px) {}

  /// How far, in standard deviations, `vertical_px` = f (y_L - y_R) is from what is expected of
  /// a correct pair of boxes; then learns from it, the less the farther beyond `gate_sigma`.
  double Observe(Utime utime, double vertical_px, double x, double noise_px, double gate_sigma);

  double pitch_rad() const { return -state_(0) / focal_px_; }  ///< Relative, right minus left.
  double roll_rad() const { return state_(1); }
  double pitch_sigma_rad() const;
  double roll_sigma_rad() const;

 private:
  static constexpr double kOffsetSigma_px = 30, kOffsetWalk_px = 0.5;  // Walk: per √s.
  static constexpr double kRollSigma_rad = 0.02, kRollWalk_rad = 0.0005;

  double focal_px_;
  bool began_ = false;
  Utime utime_ = 0;
  Eigen::Vector2d state_ = Eigen::Vector2d::Zero();
  Eigen::Matrix2d P_ =
      Eigen::Vector2d(kOffsetSigma_px * kOffsetSigma_px, kRollSigma_rad* kRollSigma_rad)
          .asDiagonal();
};

}  // namespace windhover
