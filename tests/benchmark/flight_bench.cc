// What a second of simulated flight costs, for one aircraft.

#include <benchmark/benchmark.h>

#include "sim/rigid_flight.h"

namespace windhover {
namespace {

void RigidBodySecond(benchmark::State& state, Turbulence turbulence) {
  WindConfig wind;
  wind.mean_mps = {5, 0, 0};
  wind.turbulence = turbulence;
  const HoldPath path({0, 0, 20}, 0);
  RigidFlight flight(Aircraft{}, wind, 1, &path);
  Utime utime = 0;
  for (auto _ : state) flight.AdvanceTo(utime += 1'000'000, {});
}
BENCHMARK_CAPTURE(RigidBodySecond, steady_wind, Turbulence::kNone)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(RigidBodySecond, turbulence, Turbulence::kLight)->Unit(benchmark::kMicrosecond);

void CommandedSecond(benchmark::State& state) {
  CommandedFlight flight({0, 0, 20}, 0);
  for (auto _ : state) {
    flight.Advance(1, {{1, 0, 0}, 0});
    benchmark::DoNotOptimize(flight.State());
  }
}
BENCHMARK(CommandedSecond)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
