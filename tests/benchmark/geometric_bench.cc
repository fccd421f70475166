// How fast geometry alone goes: training data, flights set up included, and the loop closed on one
// bus.

#include <filesystem>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "learn/tuple_source.h"
#include "tests/support/one_bus.h"

namespace windhover {
namespace {

void BM_DrawTuples(benchmark::State& state, const char* preset) {
  const Scenario base =
      LoadUndrawnScenario(fmt::format("{}/scenarios/presets/{}.yaml", WINDHOVER_SOURCE_DIR, preset),
                          {"observe=geometric", "aircraft=[{id: 0}]", "description=tuples",
                           fmt::format("dataset.splits.train.pairs={}", state.range(0))});
  std::uint64_t seed = 0;
  double n = 0;
  for (auto _ : state) {
    const TupleSplits splits = DrawTuples(base, ++seed, 1);
    n += static_cast<double>(splits.train.size() + splits.val.size() + splits.test.size());
  }
  state.counters["tuples/s"] = benchmark::Counter(n, benchmark::Counter::kIsRate);
}
// As many as the paper's, and a hundred times as many.
BENCHMARK_CAPTURE(BM_DrawTuples, uavde_12mm, "uavde_12mm")
    ->Arg(2815)
    ->Arg(281500)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_DrawTuples, pretrain, "pretrain")->Arg(28150)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_DrawTuples, resonant, "resonant")->Arg(28150)->Unit(benchmark::kMillisecond);

// An aircraft follows another by its rig. `imu_rate_hz` adds that many messages a second of each.
void BM_ClosedLoop(benchmark::State& state, const char* preset) {
  const std::vector<std::string> overrides = {
      "observe=geometric",
      "description=closed loop",
      "duration_s=100",
      "frame_rate_hz=20",
      fmt::format("nav.imu_rate_hz={}", state.range(0)),
      "aircraft=[{id: 0, type: p600, carries_rig: true, controller: follow, position_m: [0, 0, "
      "20], "
      "follow: {distance_m: 10}}, {id: 1, controller: waypoints, waypoints: [{time_s: 0, "
      "position_m: [14, 0, 20]}, {time_s: 100, position_m: [80, 20, 25]}]}]"};
  const Scenario scenario = LoadScenario(
      fmt::format("{}/scenarios/presets/{}.yaml", WINDHOVER_SOURCE_DIR, preset), overrides);
  const auto log = std::filesystem::temp_directory_path() / "windhover_closed_loop.lcm";
  int n_ticks = 0;
  for (auto _ : state) {
    const RunOutcome outcome = RunOnOneBus(scenario, log);
    if (!outcome.valid) state.SkipWithError(outcome.reason.c_str());
    n_ticks += outcome.n_ticks;
  }
  std::filesystem::remove(log);
  state.counters["frames/s"] = benchmark::Counter(n_ticks, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(BM_ClosedLoop, uavde_12mm, "uavde_12mm")
    ->ArgName("imu_rate_hz")
    ->Arg(0)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
