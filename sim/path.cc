#include "sim/path.h"

#include "common/geometry/rotation.h"

namespace windhover {

HoldPath::HoldPath(const Eigen::Vector3d& p_WB_m, double yaw_rad) {
  state_.p_WB_m = p_WB_m;
  state_.q_WB = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
}

Kinematics HoldPath::At(double /*t_s*/) const { return state_; }

std::unique_ptr<Path> MakePath(const Aircraft& aircraft, double end_s) {
  switch (aircraft.self.controller) {
    case Controller::kHold:
      return std::make_unique<HoldPath>(Eigen::Vector3d(aircraft.position_m.data()),
                                        RadFromDeg(aircraft.yaw_deg));
    case Controller::kTrajectory:
      return std::make_unique<RecordedPath>(aircraft.trajectory, end_s);
    case Controller::kWaypoints:
      return std::make_unique<WaypointPath>(aircraft.waypoints);
    case Controller::kFollow:
    case Controller::kSwarm:
      return nullptr;
  }
  return nullptr;
}

}  // namespace windhover
