#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/bus/codec.h"
#include "common/process/process.h"
#include "sim/sim_node.h"

namespace windhover {
namespace {

struct SimArgs {
  bool realtime = false;
  double truth_at_s = std::numeric_limits<double>::quiet_NaN();
  std::string out;
};

// One line for the launcher, at once.
void Say(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

nlohmann::json JsonOf(const status_t& status) {
  nlohmann::json stages = nlohmann::json::array();
  for (const stage_timing_t& stage : status.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"n", stage.n},
                      {"wall_ms", stage.wall_ms},
                      {"cpu_ms", stage.cpu_ms}});
  }
  return {{"process", status.process}, {"stages", stages}};
}

nlohmann::json JsonOf(const std::map<std::string, ChannelCount>& counts) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [channel, count] : counts) {
    json[channel] = {
        {"sent", count.sent}, {"received", count.received}, {"rejected", count.rejected}};
  }
  return json;
}

// The truth at a time of its own choosing, for a picture of one instant.
void WriteTruth(const Scenario& scenario, const SimArgs& sim_args) {
  World world(scenario);
  world.AdvanceTo(UtimeFromSeconds(sim_args.truth_at_s));
  const auto bytes = Encode(world.Truth());
  std::ofstream out(sim_args.out, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error(fmt::format("cannot write '{}'", sim_args.out));
}

void RunSim(const ProcessArgs& args, const SimArgs& sim_args) {
  const Scenario scenario = LoadScenario(args.scenario_file);
  if (!std::isnan(sim_args.truth_at_s)) return WriteTruth(scenario, sim_args);
  Bus bus(args.url);
  SimOptions options;
  options.run_id = args.run_id;
  options.log_file = std::filesystem::path(args.run_dir) / "run.lcm";
  options.pixels = RecordedPixelsFromName(args.record);
  options.realtime = sim_args.realtime;
  options.on_tick = [](int tick, int n) { Say(fmt::format("tick {} {}", tick, n)); };
  SimNode node(scenario, options, bus);
  const RunOutcome outcome = node.Run();
  for (const status_t& status : outcome.status) Say("status " + JsonOf(status).dump());
  Say("counts " + JsonOf(bus.Counts()).dump());
  if (outcome.valid) return;
  Say(fmt::format("invalid {}: {}", outcome.culprit, outcome.reason));
  throw std::runtime_error(fmt::format("run invalid: {}: {}", outcome.culprit, outcome.reason));
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  windhover::SimArgs sim_args;
  return windhover::RunProcess(
      "windhover-sim", "moves the aircraft and leads the lock-step", argc, argv,
      [&](const windhover::ProcessArgs& args) { windhover::RunSim(args, sim_args); },
      [&](CLI::App& app) {
        app.add_flag("--realtime", sim_args.realtime, "wait where the run is ahead of the clock");
        auto* const truth_at = app.add_option("--truth-at", sim_args.truth_at_s,
                                              "only write the truth of this time, s; needs no bus")
                                   ->check(CLI::Range(0.0, 1e5));
        truth_at->needs(app.add_option("--out", sim_args.out, "file for --truth-at"));
        app.get_option("--lcm-url")->required(false);
      });
}
