#include "sim/flatness.h"

#include <cmath>

namespace windhover {

using Eigen::Vector3d;

namespace {

// Derivative of v / |v| given that of v.
Vector3d DerivativeOfUnit(const Vector3d& unit, const Vector3d& derivative, double norm) {
  return (derivative - unit * unit.dot(derivative)) / norm;
}

}  // namespace

void SetAttitude(const Vector3d& jerk_mps3, double yaw_rad, double yaw_rate_radps,
                 Kinematics* state) {
  const Vector3d thrust_mps2 = state->a_WB_mps2 - GravityInWorld();
  const Vector3d z = thrust_mps2.normalized();
  const Vector3d dz = DerivativeOfUnit(z, jerk_mps3, thrust_mps2.norm());

  const Vector3d heading(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  const Vector3d d_heading = yaw_rate_radps * Vector3d(-heading.y(), heading.x(), 0);
  const Vector3d left = z.cross(heading);
  const Vector3d y = left.normalized();
  const Vector3d dy = DerivativeOfUnit(y, dz.cross(heading) + z.cross(d_heading), left.norm());
  const Vector3d x = y.cross(z);
  const Vector3d dx = dy.cross(z) + y.cross(dz);

  Eigen::Matrix3d R_WB;
  R_WB << x, y, z;
  state->q_WB = Eigen::Quaterniond(R_WB).normalized();
  // The columns of R^T dR/dt are the cross products with the angular velocity in B.
  state->w_WB_B_radps = Vector3d(z.dot(dy), x.dot(dz), y.dot(dx));
}

}  // namespace windhover
