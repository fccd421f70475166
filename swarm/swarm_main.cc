#include <fmt/format.h>

#include "common/process/process.h"
#include "swarm/swarm_node.h"

namespace {

void RunSwarm(const windhover::ProcessArgs& args) {
  const windhover::AircraftConfig config = windhover::LoadAircraftConfig(args.scenario_file);
  windhover::Bus bus(args.url);
  windhover::TickClient client(bus, fmt::format("swarm-{}", args.share.index), args.run_id);
  const windhover::SwarmNode node(config, args.share, client);
  while (!client.Ended() && !windhover::StopRequested()) {
    client.Announce();
    bus.Handle(/*timeout_ms=*/100);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return windhover::RunProcess("windhover-swarm", "flies aircraft by what they see", argc, argv,
                               RunSwarm);
}
