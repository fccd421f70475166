#pragma once

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "common/time/sim_time.h"
#include "swarm/flight_controller.h"

namespace windhover {

/// Keeps its distance from the nearest aircraft that it sees, at the same height, facing it.
///
/// Towards (or away from) the target it flies at BrakingSpeed of the distance error; the target
/// is where the method `in_loop` puts it, through the calibrated mount and its own attitude.
/// Frames without an estimate are bridged with the last known place for 1 s; then it hovers.
/// It accelerates so gently that the tilt this takes does not lift the target out of the image;
/// closer than half its distance, getting away comes first.
class FollowController : public FlightController {
 public:
  FollowController(const AircraftConfig& config, const FollowConfig& follow);

  velocity_command_t Control(const nav_state_t& nav, const range_t& ranges) override;

  /// Acceleration that keeps the target in view: its tilt is 0.6 of the rig's half vertical field.
  double GentleAcceleration_mps2() const { return gentle_mps2_; }

 private:
  /// What it wants to do before the limits on acceleration.
  struct Wish {
    Eigen::Vector3d v_WB_mps = Eigen::Vector3d::Zero();
    double yaw_rate_radps = 0;
    double largest_mps2;  ///< Acceleration that it may take.
  };

  void Look(const nav_state_t& nav, const range_t& ranges);
  Wish WishFor(const nav_state_t& nav) const;

  FollowConfig config_;
  std::string method_;
  Eigen::Isometry3d X_BR_;
  double gentle_mps2_;
  VelocityRamp ramp_;

  std::optional<Eigen::Vector3d> p_WT_m_;  // The target, where last seen.
  Utime seen_utime_ = 0;
};

}  // namespace windhover
