#include "rig/rig_motion.h"

#include <array>
#include <utility>

#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"
#include "rig/base_vibration.h"
#include "rig/drift.h"
#include "rig/half_bar.h"
#include "rig/sinusoid_sums.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// The sums of stationary vibration: turn of the rig; tips alike and, right minus left, half each.
enum Sum { kTurnX, kTurnY, kTurnZ, kForward, kForwardApart, kUp, kUpApart, kTwist, kSums };

// From motion of the bar's root in B (forward, left, up) to the rig's (right, down, forward).
SinusoidSums StationarySums(const BaseVibration& base, const BarModes& modes, double mean_over_s) {
  // About its middle, where MeanOver begins.
  const auto mean = [mean_over_s](double frequency_hz) {
    const double half_turn_rad = EIGEN_PI * frequency_hz * mean_over_s;
    return MeanOver(mean_over_s)(frequency_hz) * std::polar(1.0, -half_turn_rad);
  };
  const auto turn = [&](const Sinusoids& rate, double sign) {
    return Filtered(rate, [&](double f) { return sign * mean(f) * Integration(f); });
  };
  const auto bend = [&](const Sinusoids& acceleration, const Mode& mode) {
    return Filtered(acceleration,
                    [&](double f) { return -modes.participation * mean(f) * Response(mode, f); });
  };
  const auto lever = [&](const Sinusoids& rate, const Mode& mode, double participation) {
    return Filtered(rate, [&](double f) {
      return participation * mean(f) * Differentiation(f) * Response(mode, f);
    });
  };
  const auto& [rate_forward, rate_left, rate_up] = base.angular_rate_radps;
  std::vector<Sinusoids> sums(kSums);
  sums[kTurnX] = turn(rate_left, -1);
  sums[kTurnY] = turn(rate_up, -1);
  sums[kTurnZ] = turn(rate_forward, 1);
  if (modes.participation > 0) {
    sums[kForward] = bend(base.acceleration_mps2[0], modes.forward);
    sums[kForwardApart] = lever(rate_up, modes.forward, -modes.angular_participation_m);
    sums[kUp] = bend(base.acceleration_mps2[2], modes.up);
    sums[kUpApart] = lever(rate_forward, modes.up, modes.angular_participation_m);
    sums[kTwist] = lever(rate_left, modes.twist, modes.twist_participation);
  }
  return SinusoidSums(sums);
}

// What does not change in a flight: a bar whose front is warmer arches forward in its middle, with
// curvature α ΔT / depth; a warm bar is longer.
PosedStereoRig Warmed(PosedStereoRig rig, const FlexConfig& flex, double half_span_m) {
  if (!flex.enabled) return rig;
  const BarSection section = SectionOf(flex);
  const double curvature_radpm =
      section.expansion_per_K * flex.thermal_gradient_K / section.depth_m;
  const double longer_m = section.expansion_per_K * flex.thermal_mean_K * half_span_m;
  for (const int side : {-1, 1}) {
    Eigen::Isometry3d& X_RC = (side < 0 ? rig.left : rig.right).X_RC;
    const Vector3d turn_rad(0, side * curvature_radpm * half_span_m, 0);
    X_RC.linear() = RotationFromVector(turn_rad) * X_RC.linear();
    X_RC.translation() +=
        Vector3d(side * longer_m, 0, -curvature_radpm * half_span_m * half_span_m / 2);
  }
  return rig;
}

// Slow and sudden changes of the cameras' relative angles: pitch, yaw, roll, as x, y, z of C.
class Slips {
 public:
  Slips(const FlexConfig& flex, std::uint64_t seed, const std::string& name)
      : landing_(flex.landing) {
    if (!flex.enabled) landing_ = {};
    const DriftConfig& drift = flex.drift;
    const std::array<double, 3> sigmas_deg = {drift.pitch_sigma_deg, drift.yaw_sigma_deg,
                                              drift.roll_sigma_deg};
    const std::array<const char*, 3> names = {"pitch", "yaw", "roll"};
    for (int axis = 0; axis < 3; ++axis) {
      if (!flex.enabled || sigmas_deg[axis] == 0) continue;
      drifts_rad_.emplace_back(
          axis, OrnsteinUhlenbeck(RadFromDeg(sigmas_deg[axis]), drift.time_constant_s,
                                  RandomStream(seed, name + "/drift/" + names[axis])));
    }
  }

  Vector3d At(double t_s) const {
    Vector3d turn_rad = Vector3d::Zero();
    if (t_s >= landing_.time_s) {
      turn_rad = RadFromDeg(1) * Vector3d(landing_.pitch_deg, landing_.yaw_deg, landing_.roll_deg);
    }
    for (const auto& [axis, drift_rad] : drifts_rad_) turn_rad[axis] += drift_rad.At(t_s);
    return turn_rad;
  }

 private:
  LandingConfig landing_;
  std::vector<std::pair<int, OrnsteinUhlenbeck>> drifts_rad_;
};

PosedCamera Moved(const PosedCamera& rest, const Eigen::Matrix3d& turn, const TipMotion& tip,
                  const Vector3d& own_turn_rad) {
  PosedCamera moved = rest;
  moved.X_RC.linear() = turn * RotationFromVector(tip.turn_rad) * rest.X_RC.linear() *
                        RotationFromVector(own_turn_rad);
  moved.X_RC.translation() = turn * (rest.X_RC.translation() + tip.shift_m);
  return moved;
}

}  // namespace

struct RigMotion::Impl {
  PosedStereoRig rest;
  double half_span_m;
  double mean_over_s;
  SinusoidSums stationary;
  DrivenBar driven;
  Slips slips;

  // `sums`: the stationary ones at t_s.
  RigDeflection DeflectionAt(double t_s, const DrivenBar::Tick& tick, const double* sums) const {
    const DrivenBar::Motion motion = mean_over_s > 0 ? tick.MeanAt(t_s, mean_over_s) : tick.At(t_s);
    const auto tip = [&](int end, int side) {
      const ModeState* const bar = &motion.bar[3 * end];
      return TipDeflection{.forward_m = bar[0].x + sums[kForward] + side * sums[kForwardApart],
                           .up_m = bar[1].x + sums[kUp] + side * sums[kUpApart],
                           .twist_rad = bar[2].x + sums[kTwist]};
    };
    return {.turn_rad = motion.turn_rad + Vector3d(sums[kTurnX], sums[kTurnY], sums[kTurnZ]),
            .left = tip(0, -1),
            .right = tip(1, 1),
            .relative_turn_rad = slips.At(t_s)};
  }

  PosedStereoRig At(double t_s, const DrivenBar::Tick& tick, const double* sums) const {
    const RigDeflection now = DeflectionAt(t_s, tick, sums);
    const Eigen::Matrix3d turn = RotationFromVector(now.turn_rad);
    const Vector3d half_rad = now.relative_turn_rad / 2;
    return {Moved(rest.left, turn, MotionOf(now.left, half_span_m, -1), -half_rad),
            Moved(rest.right, turn, MotionOf(now.right, half_span_m, 1), half_rad)};
  }
};

RigMotion::RigMotion(const StereoRig& calibrated, const Misalignment& misalignment,
                     const FlexConfig& flex, const VibrationConfig& vibration, std::uint64_t seed,
                     const std::string& name, double mean_over_s) {
  const double half_span_m = calibrated.baseline_m / 2;
  impl_ = std::make_unique<const Impl>(
      Impl{Warmed(Misaligned(calibrated, Drawn(misalignment, seed, name)), flex, half_span_m),
           half_span_m, mean_over_s,
           StationarySums(MakeBaseVibration(vibration, seed, name),
                          ModesOf(flex, calibrated.baseline_m), mean_over_s),
           DrivenBar(flex, vibration, calibrated.baseline_m, seed, name), Slips(flex, seed, name)});
}

RigMotion::~RigMotion() = default;
RigMotion::RigMotion(RigMotion&&) noexcept = default;

RigDeflection RigMotion::DeflectionAt(double t_s, const RigDrive& drive) const {
  std::array<double, kSums> sums;
  impl_->stationary.At(t_s, sums.data());
  return impl_->DeflectionAt(t_s, DrivenBar::Tick(impl_->driven, drive), sums.data());
}

PosedStereoRig RigMotion::At(double t_s, const RigDrive& drive) const {
  return AtMany({t_s}, drive).front();
}

PosedStereoRig RigMotion::AtAlone(double t_s, const RigDrive& drive) const {
  std::array<double, kSums> sums;
  impl_->stationary.AtAlone(t_s, sums.data());
  return impl_->At(t_s, DrivenBar::Tick(impl_->driven, drive), sums.data());
}

std::vector<PosedStereoRig> RigMotion::AtMany(const std::vector<double>& times_s,
                                              const RigDrive& drive) const {
  const DrivenBar::Tick tick(impl_->driven, drive);
  const std::vector<double> sums = impl_->stationary.AtMany(times_s);
  std::vector<PosedStereoRig> rigs;
  rigs.reserve(times_s.size());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    rigs.push_back(impl_->At(times_s[i], tick, &sums[i * kSums]));
  }
  return rigs;
}

}  // namespace windhover
