#include <fmt/format.h>

#include "common/process/process.h"
#include "estimator/estimator_node.h"

namespace {

void RunEstimator(const windhover::ProcessArgs& args) {
  const windhover::AircraftConfig config = windhover::LoadAircraftConfig(args.scenario_file);
  windhover::Bus bus(args.url);
  windhover::TickClient client(bus, fmt::format("estimator-{}", args.share.index), args.run_id);
  const windhover::EstimatorNode node(config, args.share, client);
  while (!client.Ended() && !windhover::StopRequested()) {
    client.Announce();
    bus.Handle(/*timeout_ms=*/100);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return windhover::RunProcess("windhover-estimator",
                               "turns stereo frames into distances to other aircraft", argc, argv,
                               RunEstimator);
}
