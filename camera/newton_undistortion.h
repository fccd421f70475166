#pragma once

#include <algorithm>
#include <optional>

#include <Eigen/Core>
#include <Eigen/LU>

namespace windhover {

/// The distorted image-plane point and its derivative with respect to the undistorted one.
struct DistortedPoint {
  Eigen::Vector2d point;
  Eigen::Matrix2d derivative;
};

/// Solves distort(x) = `target` by Newton's method from `start`, to 1e-13 of the image plane (1e-9
/// px at f = 10⁴ px). `distort` maps a point to a DistortedPoint. A step that makes things worse
/// has left the invertible region and is halved.
/// @return nothing if the iteration does not arrive; the caller checks that it arrived at a point
/// where the lens is invertible.
template <typename Distort>
std::optional<Eigen::Vector2d> SolveDistortion(const Distort& distort,
                                               const Eigen::Vector2d& target,
                                               const Eigen::Vector2d& start) {
  constexpr int kMaxIterations = 50, kMaxHalvings = 30;
  constexpr double kTolerance = 1e-13;

  // Rounding grows with the distance from the axis.
  const double tolerance = kTolerance * std::max(1.0, target.norm());
  Eigen::Vector2d undistorted = start;
  DistortedPoint distorted = distort(undistorted);
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d error = distorted.point - target;
    if (error.norm() < tolerance) return undistorted;
    Eigen::Vector2d step = distorted.derivative.inverse() * error;
    distorted = distort(undistorted - step);
    for (int j = 0; j < kMaxHalvings && !((distorted.point - target).norm() < error.norm()); ++j) {
      step /= 2;
      distorted = distort(undistorted - step);
    }
    undistorted -= step;
  }
  return std::nullopt;
}

}  // namespace windhover
