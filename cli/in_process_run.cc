#include "cli/in_process_run.h"

#include <chrono>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "cli/progress.h"
#include "common/bus/bus.h"
#include "common/bus/tick_client.h"
#include "common/process/process.h"
#include "estimator/estimator_node.h"
#include "render/render_node.h"
#include "sim/sim_node.h"
#include "swarm/swarm_node.h"

namespace windhover {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kRunId = 1;  // No other run can be on this bus.

Json StagesOf(const status_t& status) {
  Json stages = Json::array();
  for (const stage_timing_t& stage : status.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"n", stage.n},
                      {"wall_ms", stage.wall_ms},
                      {"cpu_ms", stage.cpu_ms}});
  }
  return stages;
}

double PeakRss_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

RunSummary Summary(const RunOutcome& outcome, const Bus& bus, double wall_s) {
  RunSummary summary;
  summary.valid = outcome.valid;
  summary.interrupted = StopRequested();
  summary.culprit = outcome.valid || !outcome.culprit.empty() ? outcome.culprit : "windhover";
  summary.reason = outcome.reason;
  summary.n_ticks = outcome.n_ticks;
  summary.wall_s = wall_s;
  for (const status_t& status : outcome.status) summary.stages[status.process] = StagesOf(status);
  for (const auto& [channel, count] : bus.Counts()) {
    summary.counters[channel] = {{"sent", count.sent}, {"received", count.received}};
  }
  summary.peak_rss_mib["windhover"] = PeakRss_mib();
  return summary;
}

}  // namespace

RunSummary RunInOneProcess(const Scenario& given, const std::filesystem::path& run_dir,
                           const RunOptions& options) {
  Scenario scenario = given;
  scenario.execution = {};  // One of each.
  scenario.execution.deadline_s = given.execution.deadline_s;
  Progress progress(isatty(STDERR_FILENO) != 0);
  Clock::time_point start = Clock::now();
  SimOptions sim_options;
  sim_options.run_id = kRunId;
  sim_options.log_file = run_dir / "run.lcm";
  sim_options.pixels = RecordedPixelsFromName(options.record);
  sim_options.realtime = options.realtime;
  sim_options.on_tick = [&](int tick, int n_ticks) {
    if (tick == 0) start = Clock::now();
    if (!options.quiet) progress.Update(tick + 1, n_ticks);
  };
  Bus bus("memq://");
  SimNode sim(scenario, sim_options, bus);
  const AircraftConfig config = scenario.ForAircraft();
  TickClient render_client(bus, "render-0", kRunId);
  TickClient estimator_client(bus, "estimator-0", kRunId);
  TickClient swarm_client(bus, "swarm-0", kRunId);
  RenderNode render(scenario, {}, options.threads, render_client,
                    {.preview = options.preview, .frames_dir = run_dir / "frames"});
  const EstimatorNode estimator(config, {}, estimator_client);
  const SwarmNode swarm(config, {}, swarm_client);
  const RunOutcome outcome = sim.Run();
  return Summary(outcome, bus, std::chrono::duration<double>(Clock::now() - start).count());
}

}  // namespace windhover
