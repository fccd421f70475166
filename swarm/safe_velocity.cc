#include "swarm/safe_velocity.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance_mps = 1e-9;
constexpr double kParallel = 1e-9;  // Sine of an angle that counts as none.

/// The borders moved outward by `relaxed_mps`, and the sphere of the fastest velocities.
class NearestSearch {
 public:
  NearestSearch(std::span<const SafeHalfSpace> safe, double max_speed_mps,
                const Vector3d& preferred_mps, double relaxed_mps)
      : safe_(safe),
        max_speed_mps_(max_speed_mps),
        preferred_mps_(preferred_mps),
        relaxed_mps_(relaxed_mps) {}

  /// Nothing if no velocity is in all.
  std::optional<Vector3d> Find() const {
    Vector3d nearest = WithinRadius(preferred_mps_, max_speed_mps_);
    for (std::size_t i = 0; i < safe_.size(); ++i) {
      if (IsIn(i, nearest)) continue;
      const std::optional<Vector3d> on = OnPlane(i);
      if (!on) return std::nullopt;
      nearest = *on;
    }
    return nearest;
  }

 private:
  double Offset(std::size_t i) const { return safe_[i].offset_mps - relaxed_mps_; }

  bool IsIn(std::size_t i, const Vector3d& v_mps) const {
    return safe_[i].normal.dot(v_mps) >= Offset(i) - kTolerance_mps;
  }

  static Vector3d WithinRadius(const Vector3d& v, double radius) {
    const double norm = v.norm();
    return norm > radius ? Vector3d(v * (radius / norm)) : v;
  }

  /// The nearest on border i that is in all half-spaces before it.
  std::optional<Vector3d> OnPlane(std::size_t i) const {
    const Vector3d& normal = safe_[i].normal;
    const Vector3d middle = Offset(i) * normal;
    const double square = max_speed_mps_ * max_speed_mps_ - Offset(i) * Offset(i);
    if (square < 0) return std::nullopt;
    const Vector3d along = preferred_mps_ - normal * normal.dot(preferred_mps_);
    Vector3d nearest = middle + WithinRadius(along, std::sqrt(square));
    for (std::size_t j = 0; j < i; ++j) {
      if (IsIn(j, nearest)) continue;
      const std::optional<Vector3d> on = OnLine(i, j);
      if (!on) return std::nullopt;
      nearest = *on;
    }
    return nearest;
  }

  /// The nearest on borders i and j that is in all half-spaces before j.
  std::optional<Vector3d> OnLine(std::size_t i, std::size_t j) const {
    const Vector3d &a = safe_[i].normal, &b = safe_[j].normal;
    Vector3d direction = a.cross(b);
    const double sine = direction.norm();
    if (sine < kParallel) return std::nullopt;
    direction /= sine;
    // The point of the line that is nearest to the origin: a combination of both normals.
    const double cosine = a.dot(b), square_sine = sine * sine;
    const Vector3d middle = ((Offset(i) - cosine * Offset(j)) / square_sine) * a +
                            ((Offset(j) - cosine * Offset(i)) / square_sine) * b;
    const double square = max_speed_mps_ * max_speed_mps_ - middle.squaredNorm();
    if (square < 0) return std::nullopt;
    double low = -std::sqrt(square), high = std::sqrt(square);
    for (std::size_t k = 0; k < j; ++k) {
      const double slope = safe_[k].normal.dot(direction);
      const double missing = Offset(k) - safe_[k].normal.dot(middle);
      if (std::abs(slope) < kParallel) {
        if (missing > kTolerance_mps) return std::nullopt;
        continue;
      }
      (slope > 0 ? low : high) =
          slope > 0 ? std::max(low, missing / slope) : std::min(high, missing / slope);
    }
    if (low > high + kTolerance_mps) return std::nullopt;
    return middle +
           std::clamp(preferred_mps_.dot(direction), std::min(low, high), high) * direction;
  }

  std::span<const SafeHalfSpace> safe_;
  double max_speed_mps_;
  Vector3d preferred_mps_;
  double relaxed_mps_;
};

}  // namespace

Vector3d NearestSafeVelocity(std::span<const SafeHalfSpace> safe, double max_speed_mps,
                             const Vector3d& preferred_mps) {
  const auto nearest = [&](double relaxed_mps) {
    return NearestSearch(safe, max_speed_mps, preferred_mps, relaxed_mps).Find();
  };
  if (const auto found = nearest(0)) return *found;
  // Standing still breaks no half-space by more than its offset.
  double none = 0, some = 0;
  for (const SafeHalfSpace& half : safe) some = std::max(some, half.offset_mps);
  some += kTolerance_mps;
  while (some - none > kTolerance_mps) {
    const double middle = (none + some) / 2;
    if (middle <= none || middle >= some) break;  // Doubles this large lie farther apart.
    (nearest(middle) ? some : none) = middle;
  }
  return nearest(some).value_or(Vector3d::Zero());
}

}  // namespace windhover
