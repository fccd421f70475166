#pragma once

#include <filesystem>

#include "common/bus/tick_client.h"
#include "estimator/estimator_node.h"
#include "render/render_node.h"
#include "sim/sim_node.h"
#include "swarm/swarm_node.h"

namespace windhover {

/// Runs every node of `scenario` on one bus in this process, and writes `log`.
inline RunOutcome RunOnOneBus(const Scenario& scenario, const std::filesystem::path& log) {
  SimOptions options;
  options.run_id = 1;
  options.log_file = log;
  Bus bus("memq://");
  SimNode sim(scenario, options, bus);
  const AircraftConfig config = scenario.ForAircraft();
  TickClient render_client(bus, "render-0", 1), estimator_client(bus, "estimator-0", 1),
      swarm_client(bus, "swarm-0", 1);
  const RenderNode render(scenario, {}, 1, render_client);
  const EstimatorNode estimator(config, {}, estimator_client);
  const SwarmNode swarm(config, {}, swarm_client);
  return sim.Run();
}

}  // namespace windhover
