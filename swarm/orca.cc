#include "swarm/orca.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace windhover {
namespace {

using Eigen::Vector3d;

// A unit vector along `v`, or any if it is none.
Vector3d Direction(const Vector3d& v, const Vector3d& otherwise) {
  const double norm = v.norm();
  return norm > 1e-9 ? Vector3d(v / norm) : otherwise;
}

// The least change that takes a relative velocity out of the velocities that end in a collision
// within the horizon: along a unit vector, so far.
struct Change {
  Vector3d along;
  double size_mps;
};

Change ChangeFor(const Vector3d& p_m, const Vector3d& v_mps, double apart_m, double horizon_s) {
  const Vector3d w_mps = v_mps - p_m / horizon_s;  // From the middle of the cut-off sphere.
  const double towards = w_mps.dot(p_m);
  const Vector3d away = Direction(-p_m, Vector3d::UnitX());
  const bool touches = p_m.norm() <= apart_m;
  if (touches || (towards < 0 && towards * towards > apart_m * apart_m * w_mps.squaredNorm())) {
    return {Direction(w_mps, away), apart_m / horizon_s - w_mps.norm()};
  }
  // Nearest point of the cone around p: in the plane of p and v, at the angle asin(R / |p|).
  const Vector3d axis = p_m.normalized();
  const Vector3d across = v_mps - axis * axis.dot(v_mps);
  const Vector3d side = Direction(across, axis.unitOrthogonal());
  const double sine = apart_m / p_m.norm(), cosine = std::sqrt(1 - sine * sine);
  const Vector3d outward = cosine * side - sine * axis;
  return {outward, -v_mps.dot(outward)};
}

}  // namespace

SafeHalfSpace SafeVelocities(const OrcaConfig& config, const Neighbour& neighbour,
                             const Vector3d& v_mps, double step_s) {
  const double apart_m = 2 * config.radius_m;
  const double horizon_s = neighbour.p_m.norm() > apart_m ? config.horizon_s : step_s;
  const Change change = ChangeFor(neighbour.p_m, v_mps - neighbour.v_mps, apart_m, horizon_s);
  return {change.along, change.along.dot(v_mps) + change.size_mps / 2};
}

std::vector<Neighbour> Nearest(std::span<const Neighbour> neighbours, int n) {
  std::vector<Neighbour> nearest(neighbours.begin(), neighbours.end());
  std::stable_sort(nearest.begin(), nearest.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.p_m.squaredNorm() < b.p_m.squaredNorm();
  });
  nearest.resize(std::min(nearest.size(), static_cast<std::size_t>(n)));
  return nearest;
}

Vector3d OrcaVelocity(const OrcaConfig& config, std::span<const Neighbour> neighbours,
                      const Vector3d& v_mps, const Vector3d& preferred_mps, double max_speed_mps,
                      double step_s) {
  std::vector<SafeHalfSpace> safe;
  for (const Neighbour& neighbour : Nearest(neighbours, config.max_neighbours)) {
    safe.push_back(SafeVelocities(config, neighbour, v_mps, step_s));
  }
  return NearestSafeVelocity(safe, max_speed_mps, preferred_mps);
}

}  // namespace windhover
