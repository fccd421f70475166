#include "swarm/flocking.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTouching_m = 1e-3;  // Nearer, a direction means nothing.

}  // namespace

Vector3d ReynoldsVelocity(const ReynoldsConfig& config, std::span<const Neighbour> neighbours,
                          const Vector3d& migration_mps) {
  Vector3d sum = Vector3d::Zero();
  for (const Neighbour& neighbour : neighbours) {
    const double square_m2 = std::max(neighbour.p_m.squaredNorm(), kTouching_m * kTouching_m);
    sum += (config.cohesion_per_s - config.separation_m2ps / square_m2) * neighbour.p_m +
           config.alignment * neighbour.v_mps;
  }
  const double n = std::max<double>(1, static_cast<double>(neighbours.size()));
  return sum / n + config.migration * migration_mps;
}

double BrakingSpeed(double error_m, double gain_per_s, double deceleration_mps2) {
  if (gain_per_s <= 0) return 0;
  const double distance_m = std::abs(error_m), knee_mps = deceleration_mps2 / gain_per_s;
  const double speed_mps =
      distance_m * gain_per_s < knee_mps
          ? distance_m * gain_per_s
          : std::sqrt(2 * deceleration_mps2 * distance_m - knee_mps * knee_mps);
  return std::copysign(speed_mps, error_m);
}

double StoppingDistance(double speed_mps, double gain_per_s, double deceleration_mps2) {
  const double v_mps = std::abs(speed_mps), knee_mps = deceleration_mps2 / gain_per_s;
  const double distance_m = v_mps < knee_mps
                                ? v_mps / gain_per_s
                                : (v_mps * v_mps / deceleration_mps2 + knee_mps / gain_per_s) / 2;
  return std::copysign(distance_m, speed_mps);
}

Vector3d VasarhelyiVelocity(const VasarhelyiConfig& config, std::span<const Neighbour> neighbours,
                            const Vector3d& v_mps, const Vector3d& migration_mps) {
  Vector3d velocity = migration_mps;
  const double friction_m = config.repulsion_m + config.friction_reach_m;
  for (const Neighbour& neighbour : neighbours) {
    const double distance_m = neighbour.p_m.norm();
    if (distance_m < config.repulsion_m && distance_m > kTouching_m) {
      velocity -=
          config.repulsion_per_s * (config.repulsion_m - distance_m) / distance_m * neighbour.p_m;
    }
    const Vector3d relative_mps = neighbour.v_mps - v_mps;
    const double allowed_mps = std::max(
        config.friction_slack_mps, BrakingSpeed(std::max(distance_m - friction_m, 0.0),
                                                config.friction_gain_per_s, config.friction_mps2));
    const double excess_mps = relative_mps.norm() - allowed_mps;
    if (excess_mps > 0) velocity += config.friction * excess_mps * relative_mps.normalized();
  }
  return velocity;
}

}  // namespace windhover
