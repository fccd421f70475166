#include "eval/braking.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace windhover {
namespace {

using Eigen::Vector3d;

/// Distance of stopping from a speed, odd in it: v / p below the knee a / p, (v² / a + a / p²) / 2
/// above.
double StoppingDistance_m(const GuardConfig& guard, double speed_mps) {
  const double a = guard.deceleration_mps2, p = guard.gain_per_s, v = std::abs(speed_mps);
  const double distance_m = v < a / p ? v / p : (v * v / a + a / (p * p)) / 2;
  return std::copysign(distance_m, speed_mps);
}

/// Whether two that are `p_m` apart and move by `v_mps` to each other are ever nearer than keep_m.
bool ComesWithin(double keep_m, const Vector3d& p_m, const Vector3d& v_mps) {
  if (p_m.norm() <= keep_m) return true;
  const double closing = -p_m.dot(v_mps);
  return closing > 0 && p_m.cross(v_mps).norm() < keep_m * v_mps.norm();
}

}  // namespace

bool MustBrake(const SwarmConfig& config, const uav_truth_t& self, const world_truth_t& tick,
               const Vector3d& wish_W_mps) {
  const GuardConfig& guard = config.guard;
  const Vector3d own_v_mps(self.v_WB_mps);
  return std::any_of(tick.uavs.begin(), tick.uavs.end(), [&](const uav_truth_t& other) {
    if (other.id == self.id) return false;
    const Vector3d p_m = Vector3d(other.p_WB_m) - Vector3d(self.p_WB_m), v_mps(other.v_WB_mps);
    if (!ComesWithin(guard.stop_m, p_m, v_mps - wish_W_mps)) return false;
    const Vector3d line = p_m.norm() > 1e-6 ? Vector3d(p_m.normalized()) : Vector3d::UnitX();
    const double away_mps =
        std::clamp(v_mps.dot(line), -config.max_speed_mps, config.max_speed_mps);
    const double closing_mps = std::max(0.0, own_v_mps.dot(line) - away_mps);
    const double room_m = p_m.norm() - guard.stop_m - guard.reaction_s * closing_mps +
                          StoppingDistance_m(guard, away_mps);
    return StoppingDistance_m(guard, wish_W_mps.dot(line)) > room_m;
  });
}

}  // namespace windhover
