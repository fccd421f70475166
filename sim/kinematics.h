#pragma once

#include <Eigen/Geometry>

namespace windhover {

/// How a body B moves in the world W (east-north-up), at one moment.
struct Kinematics {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_WB_mps = Eigen::Vector3d::Zero();   ///< Expressed in W.
  Eigen::Vector3d a_WB_mps2 = Eigen::Vector3d::Zero();  ///< Expressed in W.
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d w_WB_B_radps = Eigen::Vector3d::Zero();  ///< Expressed in B.
};

inline constexpr double kGravity_mps2 = 9.80665;

/// Gravity as an acceleration, in W.
inline Eigen::Vector3d GravityInWorld() { return {0, 0, -kGravity_mps2}; }

}  // namespace windhover
