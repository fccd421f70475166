#pragma once

#include <memory>
#include <vector>

#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "scenarios/aircraft_config.h"
#include "swarm/flight_controller.h"

namespace windhover {

/// Puts flight controllers on the bus. For each aircraft i of its share, every tick:
///
///     in   NAV_STATE_i, and RANGE_i if it carries a rig
///     out  VELOCITY_COMMAND_i, if a controller here moves it
///
/// A controller sees nothing of other aircraft but what their images tell.
class SwarmNode {
 public:
  /// Subscribes through `client`, which must outlive the node's use.
  SwarmNode(const AircraftConfig& config, const ProcessShare& share, TickClient& client);
  SwarmNode(const SwarmNode&) = delete;

 private:
  struct Pilot {
    int id = 0;
    nav_state_t nav{};
    range_t ranges{};
    std::unique_ptr<FlightController> controller;  ///< Null: sim moves this one.
  };

  void Process(const tick_t& tick);

  TickClient& client_;
  std::vector<std::unique_ptr<Pilot>> pilots_;  ///< By id; the client fills in their messages.
};

}  // namespace windhover
