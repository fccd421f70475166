#pragma once

#include <memory>
#include <optional>

#include <Eigen/Geometry>

#include "common/time/sim_time.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Decides what one aircraft does next from what it knows of itself and what it sees. One class a
/// file; MakeFlightController knows them all.
class FlightController {
 public:
  virtual ~FlightController() = default;

  /// Called once per tick, in order of time. `ranges` is empty where the aircraft sees nothing.
  virtual velocity_command_t Control(const nav_state_t& nav, const range_t& ranges) = 0;
};

/// The controller that the aircraft asks for; null where sim moves it (hold, trajectory, …).
std::unique_ptr<FlightController> MakeFlightController(const AircraftConfig& config,
                                                       const AircraftSelf& self);

/// Turns wishes into commands whose velocity changes no faster than allowed.
class VelocityRamp {
 public:
  explicit VelocityRamp(double frame_s) : frame_s_(frame_s) {}

  /// The command of the tick that `nav` is of.
  velocity_command_t Towards(const Eigen::Vector3d& wish_mps, double largest_mps2,
                             double yaw_rate_radps, const nav_state_t& nav);

 private:
  double frame_s_;
  std::optional<Utime> last_utime_;
  Eigen::Vector3d last_v_WB_mps_ = Eigen::Vector3d::Zero();
};

/// Where the aircraft believes to be.
Eigen::Isometry3d X_WB(const nav_state_t& nav);

/// `v`, no longer than `largest`.
Eigen::Vector3d Limited(const Eigen::Vector3d& v, double largest);

/// Turns a rig at X_WR towards `line_W`, seen from above.
double YawRateTowards(const Eigen::Vector3d& line_W, const Eigen::Isometry3d& X_WR);

}  // namespace windhover
