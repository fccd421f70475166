#include "swarm/flock_controller.h"

#include <algorithm>

#include "swarm/collision_guard.h"
#include "swarm/orca.h"
#include "swarm/potential_laws.h"
#include "swarm/yaw_policy.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

// An aircraft's acceleration tends to (command - v) / 0.4 s (docs/physics.md, commanded flight).
constexpr double kVelocityResponse_s = 0.4;
constexpr double kGoalGain_per_s = 0.5;

}  // namespace

FlockController::FlockController(const AircraftConfig& config, const GoalConfig& goal)
    : config_(config.swarm),
      goal_(goal),
      X_BR_(config.rig.X_BR()),
      frame_s_(1 / config.frame_rate_hz),
      tracks_(config.swarm.tracks, config.estimator.in_loop, config.swarm.max_speed_mps),
      ramp_(frame_s_) {}

// Half of the braking power is left for what a law wants beside the goal.
Vector3d FlockController::Preferred(const nav_state_t& nav) const {
  Vector3d preferred_mps(config_.migration_mps.data());
  const Vector3d missing_m = Vector3d(goal_.position_m.data()) - Vector3d(nav.p_WB_m);
  if (goal_.speed_mps > 0 && missing_m.norm() > 1e-6) {
    const double speed_mps =
        BrakingSpeed(missing_m.norm(), kGoalGain_per_s, config_.max_acceleration_mps2 / 2);
    preferred_mps += std::min(speed_mps, goal_.speed_mps) * missing_m.normalized();
  }
  return preferred_mps;
}

Vector3d FlockController::WishFor(const nav_state_t& nav,
                                  const std::vector<Neighbour>& neighbours) const {
  const Vector3d preferred_mps = Preferred(nav), v_mps(nav.v_WB_mps);
  if (neighbours.empty()) return Limited(preferred_mps, config_.alone_speed_mps);
  switch (config_.controller) {
    case SwarmLaw::kNone:
      return preferred_mps;
    case SwarmLaw::kReynolds:
      return ReynoldsVelocity(config_.reynolds, neighbours, preferred_mps);
    case SwarmLaw::kOlfatiSaber:
      return v_mps + kVelocityResponse_s * OlfatiSaberAcceleration(config_.olfati_saber, neighbours,
                                                                   v_mps, preferred_mps);
    case SwarmLaw::kVasarhelyi:
      return VasarhelyiVelocity(config_.vasarhelyi, neighbours, v_mps, preferred_mps);
    case SwarmLaw::kOrca:
      return OrcaVelocity(config_.orca, neighbours, v_mps, preferred_mps, config_.max_speed_mps,
                          frame_s_);
    case SwarmLaw::kPotentialField:
      return v_mps + kVelocityResponse_s * PotentialFieldAcceleration(config_.potential_field,
                                                                      neighbours, v_mps,
                                                                      preferred_mps);
  }
  return Vector3d::Zero();
}

velocity_command_t FlockController::Control(const nav_state_t& nav, const range_t& ranges) {
  tracks_.Look(nav, X_BR_, ranges);
  const std::vector<Neighbour> neighbours = tracks_.Within(config_.perception_m, nav);
  const Vector3d wish_mps = Limited(WishFor(nav, neighbours), config_.max_speed_mps);
  const GuardedVelocity guarded =
      Guarded(config_.guard, neighbours, Vector3d(nav.v_WB_mps), wish_mps, config_.max_speed_mps);
  const double largest_mps2 =
      guarded.is_guarded ? std::max(config_.max_acceleration_mps2, config_.guard.deceleration_mps2)
                         : config_.max_acceleration_mps2;
  const double yaw_rate_radps = YawRateFor(config_, neighbours, wish_mps, X_WB(nav) * X_BR_);
  velocity_command_t command = ramp_.Towards(guarded.v_mps, largest_mps2, yaw_rate_radps, nav);
  std::copy_n(wish_mps.data(), 3, command.wish_WB_mps);  // Not the guard's.
  command.is_guarded = guarded.is_guarded ? 1 : 0;
  return command;
}

}  // namespace windhover
