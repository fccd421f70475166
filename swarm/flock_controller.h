#pragma once

#include "swarm/neighbour_tracks.h"

namespace windhover {

/// Flies by the law of `swarm.controller` on the neighbours that its own rig sees, and turns
/// towards the middle of them. Alone, it keeps to the migration and looks around.
class FlockController : public FlightController {
 public:
  explicit FlockController(const AircraftConfig& config);

  velocity_command_t Control(const nav_state_t& nav, const range_t& ranges) override;

 private:
  Eigen::Vector3d WishFor(const nav_state_t& nav, const std::vector<Neighbour>& neighbours) const;

  SwarmConfig config_;
  Eigen::Isometry3d X_BR_;
  double frame_s_;
  NeighbourTracks tracks_;
  VelocityRamp ramp_;
};

}  // namespace windhover
