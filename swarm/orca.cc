#include "swarm/orca.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

namespace windhover {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTolerance_mps = 1e-9;

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

// The point of the borders `active`, and of the sphere of radius `speed` if it is positive, nearest
// to `to`.
std::optional<Vector3d> NearestMeeting(const MatrixXd& normals, const VectorXd& offsets,
                                       double speed, const Vector3d& to) {
  Vector3d on = Vector3d::Zero(), free = to;
  if (normals.rows() > 0) {
    const auto solver = normals.completeOrthogonalDecomposition();
    if (solver.rank() < normals.rows()) return std::nullopt;
    on = solver.solve(offsets);
    free = to - solver.solve(normals * to);
  }
  if (speed <= 0) return Vector3d(on + free);
  const double rest = speed * speed - on.squaredNorm();
  if (rest < 0 || normals.rows() == 3 || free.norm() < 1e-12) return std::nullopt;
  return Vector3d(on + std::sqrt(rest) * free.normalized());
}

class Search {
 public:
  Search(std::span<const SafeHalfSpace> safe, double max_speed_mps, const Vector3d& preferred_mps)
      : safe_(safe), max_speed_mps_(max_speed_mps), preferred_mps_(preferred_mps) {}

  /// The nearest velocity if all borders move outward by `relaxed_mps`; nothing if there is none.
  std::optional<Vector3d> Nearest(double relaxed_mps) {
    relaxed_mps_ = relaxed_mps;
    best_.reset();
    std::vector<std::size_t> active;
    Visit(0, &active);
    return best_;
  }

 private:
  // Every set of up to three borders.
  void Visit(std::size_t from, std::vector<std::size_t>* active) {
    TryBorders(*active);
    if (active->size() == 3) return;
    for (std::size_t i = from; i < safe_.size(); ++i) {
      active->push_back(i);
      Visit(i + 1, active);
      active->pop_back();
    }
  }

  void TryBorders(const std::vector<std::size_t>& active) {
    MatrixXd normals(active.size(), 3);
    VectorXd offsets(active.size());
    for (std::size_t k = 0; k < active.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      normals.row(row) = safe_[active[k]].normal;
      offsets[row] = safe_[active[k]].offset_mps - relaxed_mps_;
    }
    for (const double speed : {0.0, max_speed_mps_}) {
      const auto candidate = NearestMeeting(normals, offsets, speed, preferred_mps_);
      if (candidate && IsSafe(*candidate)) Take(*candidate);
    }
  }

  bool IsSafe(const Vector3d& v_mps) const {
    if (v_mps.norm() > max_speed_mps_ + kTolerance_mps) return false;
    return std::all_of(safe_.begin(), safe_.end(), [&](const SafeHalfSpace& half) {
      return half.normal.dot(v_mps) >= half.offset_mps - relaxed_mps_ - kTolerance_mps;
    });
  }

  void Take(const Vector3d& v_mps) {
    const bool is_nearer =
        !best_ || (v_mps - preferred_mps_).squaredNorm() < (*best_ - preferred_mps_).squaredNorm();
    if (is_nearer) best_ = v_mps;
  }

  std::span<const SafeHalfSpace> safe_;
  double max_speed_mps_;
  Vector3d preferred_mps_;
  double relaxed_mps_ = 0;
  std::optional<Vector3d> best_;
};

}  // namespace

SafeHalfSpace SafeVelocities(const OrcaConfig& config, const Neighbour& neighbour,
                             const Vector3d& v_mps, double step_s) {
  const double apart_m = 2 * config.radius_m;
  const double horizon_s = neighbour.p_m.norm() > apart_m ? config.horizon_s : step_s;
  const Change change = ChangeFor(neighbour.p_m, v_mps - neighbour.v_mps, apart_m, horizon_s);
  return {change.along, change.along.dot(v_mps) + change.size_mps / 2};
}

Vector3d NearestSafeVelocity(std::span<const SafeHalfSpace> safe, double max_speed_mps,
                             const Vector3d& preferred_mps) {
  Search search(safe, max_speed_mps, preferred_mps);
  if (const auto nearest = search.Nearest(0)) return *nearest;
  // Standing still breaks no half-space by more than its offset.
  double none = 0, some = kTolerance_mps;
  for (const SafeHalfSpace& half : safe) some = std::max(some, half.offset_mps);
  for (int i = 0; i < 40; ++i) {
    const double middle = (none + some) / 2;
    (search.Nearest(middle) ? some : none) = middle;
  }
  return search.Nearest(some).value_or(Vector3d::Zero());
}

Vector3d OrcaVelocity(const OrcaConfig& config, std::span<const Neighbour> neighbours,
                      const Vector3d& v_mps, const Vector3d& preferred_mps, double max_speed_mps,
                      double step_s) {
  std::vector<SafeHalfSpace> safe;
  for (const Neighbour& neighbour : neighbours) {
    safe.push_back(SafeVelocities(config, neighbour, v_mps, step_s));
  }
  return NearestSafeVelocity(safe, max_speed_mps, preferred_mps);
}

}  // namespace windhover
