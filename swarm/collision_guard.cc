#include "swarm/collision_guard.h"

#include <algorithm>
#include <vector>

#include "swarm/safe_velocity.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kUnchanged_mps = 1e-6;

// From oneself to a neighbour; to the east where both are in one place.
Vector3d LineTo(const Neighbour& neighbour) {
  const double distance_m = neighbour.p_m.norm();
  return distance_m > 1e-6 ? Vector3d(neighbour.p_m / distance_m) : Vector3d::UnitX();
}

// Whether with `wish_mps` the neighbour, if it flies on as it does, comes as near as stop_m.
bool IsInTheWay(const GuardConfig& config, const Neighbour& neighbour, const Vector3d& wish_mps) {
  const double keep_m = config.stop_m + config.sigmas * neighbour.sigma_m;
  const double square_m2 = neighbour.p_m.squaredNorm();
  if (square_m2 <= keep_m * keep_m) return true;
  const Vector3d relative_mps = wish_mps - neighbour.v_mps;
  const double towards = relative_mps.dot(neighbour.p_m);
  if (towards <= 0) return false;
  return square_m2 - towards * towards / relative_mps.squaredNorm() < keep_m * keep_m;
}

}  // namespace

double SafeClosingSpeed(const GuardConfig& config, const Neighbour& neighbour,
                        const Vector3d& v_mps, double max_speed_mps) {
  const Vector3d line = LineTo(neighbour);
  const double leaving_mps = std::clamp(neighbour.v_mps.dot(line), -max_speed_mps, max_speed_mps);
  const double closing_mps = std::max(0.0, v_mps.dot(line) - leaving_mps);
  const double gap_m = neighbour.p_m.norm() - config.sigmas * neighbour.sigma_m - config.stop_m -
                       config.reaction_s * closing_mps;
  const double room_m =
      gap_m + StoppingDistance(leaving_mps, config.gain_per_s, config.deceleration_mps2);
  return BrakingSpeed(room_m, config.gain_per_s, config.deceleration_mps2);
}

GuardedVelocity Guarded(const GuardConfig& config, std::span<const Neighbour> neighbours,
                        const Vector3d& v_mps, const Vector3d& wish_mps, double max_speed_mps) {
  if (!config.enabled) return {wish_mps, false};
  std::vector<SafeHalfSpace> safe;
  for (const Neighbour& neighbour : neighbours) {
    if (!IsInTheWay(config, neighbour, wish_mps)) continue;
    safe.push_back(
        {-LineTo(neighbour), -SafeClosingSpeed(config, neighbour, v_mps, max_speed_mps)});
  }
  const Vector3d nearest = NearestSafeVelocity(safe, max_speed_mps, wish_mps);
  return {nearest, (nearest - wish_mps).norm() > kUnchanged_mps};
}

}  // namespace windhover
