#include "swarm/flock_controller.h"

#include "swarm/orca.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kSearch_radps = 0.3;

}  // namespace

FlockController::FlockController(const AircraftConfig& config)
    : config_(config.swarm),
      X_BR_(config.rig.X_BR()),
      frame_s_(1 / config.frame_rate_hz),
      tracks_(config.estimator.in_loop),
      ramp_(frame_s_) {}

Vector3d FlockController::WishFor(const nav_state_t& nav,
                                  const std::vector<Neighbour>& neighbours) const {
  const Vector3d migration_mps(config_.migration_mps.data()), v_mps(nav.v_WB_mps);
  switch (config_.controller) {
    case SwarmLaw::kReynolds:
      return ReynoldsVelocity(config_.reynolds, neighbours, migration_mps);
    case SwarmLaw::kVasarhelyi:
      return VasarhelyiVelocity(config_.vasarhelyi, neighbours, v_mps, migration_mps);
    case SwarmLaw::kOrca:
      return OrcaVelocity(config_.orca, neighbours, v_mps, migration_mps, config_.max_speed_mps,
                          frame_s_);
  }
  return Vector3d::Zero();
}

velocity_command_t FlockController::Control(const nav_state_t& nav, const range_t& ranges) {
  tracks_.Look(nav, X_BR_, ranges);
  const std::vector<Neighbour> neighbours = tracks_.Within(config_.perception_m, nav);
  const Vector3d wish_mps = Limited(WishFor(nav, neighbours), config_.max_speed_mps);
  Vector3d line = Vector3d::Zero();
  for (const Neighbour& neighbour : neighbours) line += neighbour.p_m;
  const double yaw_rate_radps =
      neighbours.empty() ? kSearch_radps : YawRateTowards(line, X_WB(nav) * X_BR_);
  return ramp_.Towards(wish_mps, config_.max_acceleration_mps2, yaw_rate_radps, nav);
}

}  // namespace windhover
