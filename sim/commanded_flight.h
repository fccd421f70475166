#pragma once

#include "sim/kinematics.h"

namespace windhover {

/// What a commanded aircraft is to do.
struct FlightCommand {
  Eigen::Vector3d v_WB_mps = Eigen::Vector3d::Zero();
  double yaw_rate_radps = 0;
};

/// A multirotor under velocity control. Acceleration tends to (command - v) / 0.4 s, at most
/// 6 m/s², with a lag of 0.1 s: together a critically damped response without overshoot. Its
/// attitude is the one that such an acceleration needs. Source of the limit: G. Vásárhelyi et
/// al., "Optimized flocking of autonomous drones in confined environments", Sci. Robot. 2018.
class CommandedFlight {
 public:
  CommandedFlight(const Eigen::Vector3d& p_WB_m, double yaw_rad);

  /// Flies on for `duration_s` under `command`.
  void Advance(double duration_s, const FlightCommand& command);

  Kinematics State() const;

 private:
  using Motion = Eigen::Matrix<double, 3, 3>;  // Columns: position, velocity, acceleration.

  static Motion Derivative(const Motion& motion, const FlightCommand& command);
  static Eigen::Vector3d Jerk(const Motion& motion, const FlightCommand& command);
  void Step(double h_s, const FlightCommand& command);

  Motion motion_ = Motion::Zero();
  double yaw_rad_ = 0, yaw_rate_radps_ = 0;
  FlightCommand command_;
};

}  // namespace windhover
