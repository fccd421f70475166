#pragma once

#include <string>

#include "common/time/sim_time.h"
#include "scenarios/scenario.h"
#include "sim/autopilot.h"
#include "sim/commanded_flight.h"
#include "sim/path.h"
#include "sim/quadrotor.h"
#include "sim/rotors.h"
#include "sim/wind.h"

namespace windhover {

/// An aircraft that forces move: quadrotor, flight controller and wind, 500 times a second.
///
/// It follows a path, with acceleration, jerk and heading fed forward, or velocity commands, which
/// CommandedFlight shapes. It starts as if it had been flying so in the mean wind.
class RigidFlight {
 public:
  /// @param path what to follow; null for velocity commands. Must outlive this.
  RigidFlight(const Aircraft& aircraft, const WindConfig& wind, std::uint64_t seed,
              const Path* path);

  /// Flies on until `utime`. @pre utime is not before the present.
  /// @throws RunInvalid naming what is no longer finite.
  void AdvanceTo(Utime utime, const FlightCommand& command);

  /// How the body frame moves.
  Kinematics State() const { return quadrotor_.Body(wind_W_mps_); }

  RotorsTurning Turning() const;
  const Eigen::Vector3d& wind_W_mps() const { return wind_W_mps_; }

 private:
  void Control(const FlightCommand& command);
  FlightReference Reference(const FlightCommand& command);
  void Start();
  [[noreturn]] void FailNotFinite(const char* what) const;

  std::string name_;
  const Path* path_;
  CommandedFlight shaped_;
  Quadrotor quadrotor_;
  Autopilot autopilot_;
  Wind wind_;
  Eigen::Vector3d wind_W_mps_;
  Eigen::Vector4d command_radps_ = Eigen::Vector4d::Zero();
  Utime utime_ = 0;
};

}  // namespace windhover
