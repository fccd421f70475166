#pragma once

#include "sim/kinematics.h"
#include "sim/quadrotor.h"

namespace windhover {

/// Where an aircraft should be, and how moving.
struct FlightReference {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_WB_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d a_WB_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d jerk_W_mps3 = Eigen::Vector3d::Zero();
  double yaw_rad = 0, yaw_rate_radps = 0;
  bool holds_position = true;  ///< Otherwise only the velocity counts.
};

/// Thrusts of four rotors that come nearest to `force_N` and `torque_Nm` within what each can give
/// (`least_N` to the parameters' largest): tilting goes before lifting, lifting before turning.
Eigen::Vector4d MixedThrusts(const QuadrotorParameters& parameters, double least_N, double force_N,
                             const Eigen::Vector3d& torque_Nm);

/// A multirotor's autopilot: position and velocity errors with an integral make an acceleration
/// (at most 35 degrees of tilt), that and the heading an attitude (sim/flatness.h) with the
/// reference's jerk fed forward, the attitude's error a torque, and the mixer rotor speeds. It
/// believes in a centre of mass at B's origin. Source of the attitude loop: T. Lee, M. Leok &
/// N. H. McClamroch, "Geometric tracking control of a quadrotor UAV on SE(3)", CDC 2010.
///
/// Whatever the reference, every output is a speed that the motors can turn at.
class Autopilot {
 public:
  explicit Autopilot(const QuadrotorParameters& parameters);

  /// Starts with what holds against a constant disturbance: `drag_N` in W, and the torque that
  /// `thrusts_N` has about B's origin.
  void StartFrom(const Trim& trim);

  /// Rotor speeds for the next dt_s.
  Eigen::Vector4d Command(const Kinematics& body, const FlightReference& reference, double dt_s);

 private:
  Eigen::Vector3d SpecificThrust(const Kinematics& body, const FlightReference& reference,
                                 double dt_s);
  Eigen::Vector3d Torque(const Kinematics& body, const Kinematics& wanted, double dt_s);

  QuadrotorParameters parameters_;
  Eigen::Vector3d disturbance_W_mps2_ = Eigen::Vector3d::Zero();  // What the integrals make up for.
  Eigen::Vector3d disturbance_B_radps2_ = Eigen::Vector3d::Zero();
};

}  // namespace windhover
