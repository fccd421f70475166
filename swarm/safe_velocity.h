#pragma once

#include <span>

#include <Eigen/Core>

namespace windhover {

/// Velocities v with normal · v >= offset are safe.
struct SafeHalfSpace {
  Eigen::Vector3d normal;  ///< Unit.
  double offset_mps;
};

/// The safe velocity nearest to `preferred_mps`, no faster than max_speed_mps; where no velocity is
/// safe, that which breaks the worst half-space least, to 1e-9 m/s.
///
/// Half-spaces are added one by one: while the nearest velocity so far is in the next, it stays;
/// else the new one is on its border, and the same is asked on that plane, then on a line. Takes
/// time in proportion to their number where few bind, at worst to its cube. Source: R. Seidel,
/// Discrete & Computational Geometry 6, 1991, with a distance for the linear objective.
Eigen::Vector3d NearestSafeVelocity(std::span<const SafeHalfSpace> safe, double max_speed_mps,
                                    const Eigen::Vector3d& preferred_mps);

}  // namespace windhover
