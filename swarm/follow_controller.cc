#include "swarm/follow_controller.h"

#include <algorithm>
#include <cmath>

#include "swarm/flocking.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kMemory_s = 1;
constexpr double kEvasion_mps2 = 3;
constexpr double kGravity_mps2 = 9.80665;

double GentleAcceleration(const CalibratedRig& rig) {
  constexpr double kShareOfField = 0.6, kLeast_mps2 = 0.3, kMost_mps2 = 3;
  const double half_field_rad = std::atan(rig.image[1] / 2.0 / rig.FocalPx());
  return std::clamp(kGravity_mps2 * std::tan(kShareOfField * half_field_rad), kLeast_mps2,
                    kMost_mps2);
}

}  // namespace

FollowController::FollowController(const AircraftConfig& config, const FollowConfig& follow)
    : config_(follow),
      method_(config.estimator.in_loop),
      X_BR_(config.rig.X_BR()),
      gentle_mps2_(GentleAcceleration(config.rig)),
      ramp_(1 / config.frame_rate_hz) {}

void FollowController::Look(const nav_state_t& nav, const range_t& ranges) {
  const range_estimate_t* nearest = nullptr;
  for (const range_estimate_t& estimate : ranges.estimates) {
    if (estimate.method != method_ || estimate.status != range_estimate_t::STATUS_OK) continue;
    if (!Vector3d(estimate.p_RT_m).allFinite()) continue;
    if (nearest == nullptr || estimate.range_m < nearest->range_m) nearest = &estimate;
  }
  if (nearest != nullptr) {
    p_WT_m_ = X_WB(nav) * X_BR_ * Vector3d(nearest->p_RT_m);
    seen_utime_ = nav.utime;
  } else if (SecondsFromUtime(nav.utime - seen_utime_) > kMemory_s) {
    p_WT_m_.reset();
  }
}

FollowController::Wish FollowController::WishFor(const nav_state_t& nav) const {
  Wish wish;
  wish.largest_mps2 = gentle_mps2_;
  if (!p_WT_m_) return wish;
  const Eigen::Isometry3d X_WR = X_WB(nav) * X_BR_;
  const Vector3d to_target_m = *p_WT_m_ - X_WR.translation();
  const Vector3d level_m(to_target_m.x(), to_target_m.y(), 0);
  const Vector3d line = level_m.norm() > 1e-3 ? level_m.normalized() : Vector3d::Zero();

  const double distance_m = to_target_m.norm();
  if (distance_m < config_.distance_m / 2)
    wish.largest_mps2 = std::max(gentle_mps2_, kEvasion_mps2);
  // A fifth of the braking power is left for the lag of the response to commands.
  const double braking_mps2 = 0.8 * wish.largest_mps2;
  const double closing_mps =
      BrakingSpeed(distance_m - config_.distance_m, config_.gain_per_s, braking_mps2);
  const double climb_mps = BrakingSpeed(to_target_m.z(), config_.gain_per_s, 0.8 * gentle_mps2_);
  wish.v_WB_mps = Limited(closing_mps * line + Vector3d(0, 0, climb_mps), config_.max_speed_mps);

  if (!line.isZero()) wish.yaw_rate_radps = YawRateTowards(line, X_WR);
  return wish;
}

velocity_command_t FollowController::Control(const nav_state_t& nav, const range_t& ranges) {
  Look(nav, ranges);
  const Wish wish = WishFor(nav);
  return ramp_.Towards(wish.v_WB_mps, wish.largest_mps2, wish.yaw_rate_radps, nav);
}

}  // namespace windhover
