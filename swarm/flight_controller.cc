#include "swarm/flight_controller.h"

#include <algorithm>
#include <cmath>

#include "swarm/flock_controller.h"
#include "swarm/follow_controller.h"

namespace windhover {

std::unique_ptr<FlightController> MakeFlightController(const AircraftConfig& config,
                                                       const AircraftSelf& self) {
  switch (self.controller) {
    case Controller::kFollow:
      return std::make_unique<FollowController>(config, self.follow);
    case Controller::kSwarm:
      return std::make_unique<FlockController>(config, self.goal);
    case Controller::kHold:
    case Controller::kTrajectory:
    case Controller::kWaypoints:
      return nullptr;
  }
  return nullptr;
}

velocity_command_t VelocityRamp::Towards(const Eigen::Vector3d& wish_mps, double largest_mps2,
                                         double yaw_rate_radps, const nav_state_t& nav) {
  const double elapsed_s = last_utime_ ? SecondsFromUtime(nav.utime - *last_utime_) : frame_s_;
  last_utime_ = nav.utime;
  last_v_WB_mps_ += Limited(wish_mps - last_v_WB_mps_, largest_mps2 * elapsed_s);
  velocity_command_t command{};
  command.utime = nav.utime;
  command.id = nav.id;
  std::copy_n(last_v_WB_mps_.data(), 3, command.v_WB_mps);
  std::copy_n(wish_mps.data(), 3, command.wish_WB_mps);
  command.yaw_rate_radps = yaw_rate_radps;
  return command;
}

Eigen::Isometry3d X_WB(const nav_state_t& nav) {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  X_WB.translation() = Eigen::Vector3d(nav.p_WB_m);
  X_WB.linear() = Eigen::Quaterniond(nav.qw, nav.qx, nav.qy, nav.qz).toRotationMatrix();
  return X_WB;
}

Eigen::Vector3d Limited(const Eigen::Vector3d& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Eigen::Vector3d(v * (largest / norm)) : v;
}

double YawRateTowards(const Eigen::Vector3d& line_W, const Eigen::Isometry3d& X_WR) {
  constexpr double kGain_per_s = 1.25, kLargest_radps = 1;
  const Eigen::Vector3d axis = X_WR.linear().col(2);  // The line of sight of the rig.
  const double bearing_rad = std::remainder(
      std::atan2(line_W.y(), line_W.x()) - std::atan2(axis.y(), axis.x()), 2 * EIGEN_PI);
  return std::clamp(kGain_per_s * bearing_rad, -kLargest_radps, kLargest_radps);
}

}  // namespace windhover
