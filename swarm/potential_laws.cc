#include "swarm/potential_laws.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTouching_m = 1e-3;        // Nearer, a direction means nothing.
constexpr double kLeastClearance_m = 0.05;  // Nearer, the force grows no more.

// ρ_h, eq. 10: 1 up to h, then half a cosine down to 0 at 1.
double Bump(double z, double h) {
  if (z < h) return 1;
  if (z >= 1) return 0;
  return (1 + std::cos(std::numbers::pi * (z - h) / (1 - h))) / 2;
}

double Reach(const OlfatiSaberConfig& config) {
  return SigmaNorm(config.reach * config.distance_m, config.epsilon);
}

}  // namespace

double SigmaNorm(double z_m, double epsilon) {
  return (std::sqrt(1 + epsilon * z_m * z_m) - 1) / epsilon;
}

double OlfatiSaberAction(const OlfatiSaberConfig& config, double z) {
  const double a = config.a, b = config.b;
  const double x = z - SigmaNorm(config.distance_m, config.epsilon);
  const double c = std::abs(a - b) / std::sqrt(4 * a * b), shifted = x + c;
  const double uneven = shifted / std::sqrt(1 + shifted * shifted);
  return Bump(z / Reach(config), config.bump) * ((a + b) * uneven + (a - b)) / 2;
}

Vector3d OlfatiSaberAcceleration(const OlfatiSaberConfig& config,
                                 std::span<const Neighbour> neighbours, const Vector3d& v_mps,
                                 const Vector3d& preferred_mps) {
  Vector3d acceleration = config.navigation_per_s * (preferred_mps - v_mps);
  for (const Neighbour& neighbour : neighbours) {
    const double distance_m = neighbour.p_m.norm();
    const double z = SigmaNorm(distance_m, config.epsilon);
    const Vector3d gradient =
        neighbour.p_m / std::sqrt(1 + config.epsilon * distance_m * distance_m);
    acceleration += config.gradient * OlfatiSaberAction(config, z) * gradient;
    acceleration +=
        config.consensus_per_s * Bump(z / Reach(config), config.bump) * (neighbour.v_mps - v_mps);
  }
  return acceleration;
}

Vector3d PotentialFieldAcceleration(const PotentialFieldConfig& config,
                                    std::span<const Neighbour> neighbours, const Vector3d& v_mps,
                                    const Vector3d& preferred_mps) {
  Vector3d acceleration = config.damping_per_s * (preferred_mps - v_mps);
  for (const Neighbour& neighbour : neighbours) {
    const double distance_m = neighbour.p_m.norm();
    if (distance_m < kTouching_m) continue;
    const double clearance_m = std::max(distance_m - config.body_m, kLeastClearance_m);
    if (clearance_m >= config.influence_m) continue;
    const double away_mps2 = config.repulsion_m4ps2 * (1 / clearance_m - 1 / config.influence_m) /
                             (clearance_m * clearance_m);
    acceleration -= away_mps2 / distance_m * neighbour.p_m;
  }
  return acceleration;
}

}  // namespace windhover
