// How fast training data are drawn: whole data sets of the paper's preset, flights set up included.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "learn/tuple_source.h"

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

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
