#include "rig/rig_motion.h"

#include <algorithm>
#include <utility>

#include <Eigen/SVD>

#include "common/geometry/rotation.h"
#include "rig/base_vibration.h"
#include "rig/bending.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

Sinusoids Negated(Sinusoids signal) {
  for (Sinusoid& line : signal) line.amplitude = -line.amplitude;
  return signal;
}

// From motion of the bar's root in B (forward, left, up) to the rig's degrees of freedom in R
// (right, down, forward).
RigLines MakeLines(const BaseVibration& base, const FlexConfig& flex) {
  const auto bend = [&](double frequency_hz) { return BendingResponse(flex, frequency_hz); };
  const auto& [rate_forward, rate_left, rate_up] = base.angular_rate_radps;
  return RigLines(
      {Negated(Filtered(rate_left, Integration)), Negated(Filtered(rate_up, Integration)),
       Filtered(rate_forward, Integration), Filtered(base.acceleration_mps2[0], bend),
       Filtered(base.acceleration_mps2[2], bend)},
      base.line_spacing_hz);
}

// Largest movement of a pixel per angle by which its camera turns, over the image.
double LargestPxPerRad(const PinholeRadtan& camera, int width_px, int height_px) {
  constexpr int kSteps = 8;
  double largest = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const auto ray_C =
          camera.Unproject({(width_px - 1.0) * i / kSteps, (height_px - 1.0) * j / kSteps});
      PixelFromPointJacobian dq_dp;
      if (!ray_C || !camera.Project(*ray_C, &dq_dp)) continue;
      largest = std::max(largest, dq_dp.jacobiSvd().singularValues()[0]);
    }
  }
  return largest;
}

PosedCamera Moved(const PosedCamera& rest, const Eigen::Matrix3d& turn, const TipMotion& tip) {
  PosedCamera moved = rest;
  moved.X_RC.linear() = turn * RotationFromVector(tip.turn_rad) * rest.X_RC.linear();
  moved.X_RC.translation() = turn * (rest.X_RC.translation() + tip.shift_m);
  return moved;
}

}  // namespace

struct RigMotion::Impl {
  PosedStereoRig rest;
  double half_span_m;
  double px_per_rad;
  RigLines lines;
};

RigMotion::RigMotion(const StereoRig& calibrated, const Misalignment& misalignment,
                     const FlexConfig& flex, const VibrationConfig& vibration, std::uint64_t seed,
                     const std::string& name) {
  const PosedStereoRig rest = Misaligned(calibrated, misalignment);
  const auto px_per_rad = [&](const PinholeRadtan& camera) {
    return LargestPxPerRad(camera, calibrated.width_px, calibrated.height_px);
  };
  impl_ = std::make_unique<const Impl>(
      Impl{rest, calibrated.baseline_m / 2,
           std::max(px_per_rad(rest.left.camera), px_per_rad(rest.right.camera)),
           MakeLines(MakeBaseVibration(vibration, seed, name), flex)});
}

RigMotion::~RigMotion() = default;
RigMotion::RigMotion(RigMotion&&) noexcept = default;

RigDeflection RigMotion::DeflectionAt(double t_s) const {
  const RigLines::Vector values = impl_->lines.At(t_s);
  return {.turn_rad = values.head<3>(), .forward_m = values[3], .up_m = values[4]};
}

PosedStereoRig RigMotion::At(double t_s) const {
  if (impl_->lines.empty()) return impl_->rest;
  const RigDeflection now = DeflectionAt(t_s);
  const Eigen::Matrix3d turn = RotationFromVector(now.turn_rad);
  const auto tip = [&](int side) {
    return BentTip(now.forward_m, now.up_m, impl_->half_span_m, side);
  };
  return {Moved(impl_->rest.left, turn, tip(-1)), Moved(impl_->rest.right, turn, tip(+1))};
}

double RigMotion::MotionBoundPx(double t0_s, double t1_s) const {
  constexpr int kIntervals = 8;
  constexpr double kNearest_m = 1;
  const RigLines& lines = impl_->lines;
  if (lines.empty()) return 0;

  RigLines::Vector low = lines.At(t0_s), high = low;
  for (int i = 1; i <= kIntervals; ++i) {
    const RigLines::Vector values = lines.At(t0_s + (t1_s - t0_s) * i / kIntervals);
    low = low.cwiseMin(values);
    high = high.cwiseMax(values);
  }
  // Between samples h apart a function leaves the chord by no more than h²/8 · max |f''|.
  const double h_s = (t1_s - t0_s) / kIntervals;
  const RigLines::Vector extent =
      (high - low + lines.LargestCurvature() * (h_s * h_s / 4)).cwiseMin(2 * lines.Largest());
  const double bend_m = extent.tail<2>().norm();
  const double turn_rad = extent.head<3>().norm();
  const double tip_rad = TipSlope_rad(bend_m, impl_->half_span_m);
  const double shift_m = bend_m + turn_rad * impl_->half_span_m;
  return impl_->px_per_rad * (turn_rad + tip_rad + shift_m / kNearest_m);
}

}  // namespace windhover
