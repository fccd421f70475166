#include "swarm/yaw_policy.h"

#include <algorithm>

#include "swarm/flight_controller.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kFlying_mps = 0.3;  // Slower, a velocity is no direction to look in.

Vector3d Sum(std::span<const Neighbour> neighbours) {
  Vector3d sum = Vector3d::Zero();
  for (const Neighbour& neighbour : neighbours) sum += neighbour.p_m;
  return sum;
}

Vector3d MostUrgent(std::span<const Neighbour> neighbours) {
  const Neighbour* most = nullptr;
  double urgency = 0;
  for (const Neighbour& neighbour : neighbours) {
    const double its = neighbour.unseen_s / std::max(1.0, neighbour.p_m.norm());
    if (its > urgency) {
      urgency = its;
      most = &neighbour;
    }
  }
  return most != nullptr ? most->p_m : Sum(neighbours);
}

Vector3d Level(const Vector3d& v, double least) {
  const Vector3d level(v.x(), v.y(), 0);
  return level.norm() >= least ? level : Vector3d::Zero();
}

Vector3d LineOf(YawPolicy policy, std::span<const Neighbour> neighbours, const Vector3d& wish_mps) {
  switch (policy) {
    case YawPolicy::kNeighbours:
      return Level(Sum(neighbours), 1e-3);
    case YawPolicy::kAttend:
      return Level(MostUrgent(neighbours), 1e-3);
    case YawPolicy::kVelocity:
      return Level(wish_mps, kFlying_mps);
    case YawPolicy::kScan:
      return Vector3d::Zero();
  }
  return Vector3d::Zero();
}

}  // namespace

double YawRateFor(const SwarmConfig& config, std::span<const Neighbour> neighbours,
                  const Vector3d& wish_mps, const Eigen::Isometry3d& X_WR) {
  const Vector3d line = LineOf(config.yaw, neighbours, wish_mps);
  return line.isZero() ? config.scan_radps : YawRateTowards(line, X_WR);
}

}  // namespace windhover
