#pragma once

#include "swarm/flight_controller.h"
#include "swarm/neighbour_tracks.h"

namespace windhover {

/// Flies by the law of `swarm.controller` on the neighbours that its own rig sees, braked by the
/// collision guard, and looks where `swarm.yaw` says. One that knows of no other keeps to its goal
/// and migration, no faster than alone_speed_mps.
class FlockController : public FlightController {
 public:
  FlockController(const AircraftConfig& config, const GoalConfig& goal);

  velocity_command_t Control(const nav_state_t& nav, const range_t& ranges) override;

 private:
  Eigen::Vector3d Preferred(const nav_state_t& nav) const;
  Eigen::Vector3d WishFor(const nav_state_t& nav, const std::vector<Neighbour>& neighbours) const;

  SwarmConfig config_;
  GoalConfig goal_;
  Eigen::Isometry3d X_BR_;
  double frame_s_;
  NeighbourTracks tracks_;
  VelocityRamp ramp_;
};

}  // namespace windhover
