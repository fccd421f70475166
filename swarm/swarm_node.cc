#include "swarm/swarm_node.h"

#include <utility>

#include "common/bus/channels.h"

namespace windhover {

SwarmNode::SwarmNode(const AircraftConfig& config, const ProcessShare& share, TickClient& client)
    : client_(client) {
  for (std::size_t i = 0; i < config.aircraft.size(); ++i) {
    if (!share.Owns(static_cast<int>(i))) continue;
    const AircraftSelf& self = config.aircraft[i];
    auto pilot = std::make_unique<Pilot>();
    pilot->id = self.id;
    pilot->controller = MakeFlightController(config, self);
    client.Require(channel::NavState(self.id), &pilot->nav);
    if (self.carries_rig) client.Require(channel::Range(self.id), &pilot->ranges);
    pilots_.push_back(std::move(pilot));
  }
  client.OnTick([this](const tick_t& tick) { Process(tick); });
}

void SwarmNode::Process(const tick_t& tick) {
  const auto scope = client_.Timer().Start("control");
  for (const auto& pilot : pilots_) {
    if (!pilot->controller) continue;
    velocity_command_t command{};
    command.utime = tick.utime;
    command.id = pilot->id;
    // A rehearsal must leave no trace in the controller.
    if (tick.phase == tick_t::PHASE_RUN) {
      command = pilot->controller->Control(pilot->nav, pilot->ranges);
    }
    client_.Publish(channel::VelocityCommand(pilot->id), command);
  }
}

}  // namespace windhover
