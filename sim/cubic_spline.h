#pragma once

#include <vector>

#include <Eigen/Core>

namespace windhover {

/// A smooth curve through points at given times: cubic between them, position, velocity and
/// acceleration continuous, no acceleration at its ends (the natural spline). Source: C. de
/// Boor, "A Practical Guide to Splines", 1978.
class CubicSpline {
 public:
  /// @pre at least two points, times rising.
  CubicSpline(std::vector<double> times_s, std::vector<Eigen::Vector3d> points);

  struct Sample {
    Eigen::Vector3d value, first, second, third;  ///< And its derivatives by time.
  };

  /// Before the first and after the last time the end cubics go on.
  Sample At(double t_s) const;

 private:
  std::vector<double> times_s_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3d> second_;  ///< Second derivatives at the points.
};

}  // namespace windhover
