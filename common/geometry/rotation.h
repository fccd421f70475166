#pragma once

#include <Eigen/Geometry>

namespace windhover {

/// Rotation by |w| radians about w.
inline Eigen::Matrix3d RotationFromVector(const Eigen::Vector3d& w_rad) {
  const double angle_rad = w_rad.norm();
  if (angle_rad < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle_rad, w_rad / angle_rad).toRotationMatrix();
}

inline double RadFromDeg(double deg) { return deg * (EIGEN_PI / 180); }
inline double DegFromRad(double rad) { return rad * (180 / EIGEN_PI); }

/// Axes of a camera that looks along the body's x: C right-down-forward, B forward-left-up.
inline Eigen::Matrix3d R_BC_Forward() {
  Eigen::Matrix3d R_BC;
  R_BC << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return R_BC;
}

}  // namespace windhover
