// How long the true rig takes to evaluate: once per camera exposure sample.

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/random/random_stream.h"
#include "rig/rig_motion.h"
#include "rig/sinusoid_sums.h"

namespace windhover {
namespace {

RigMotion Motion(const VibrationConfig& vibration) {
  const PinholeRadtan camera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};
  FlexConfig flex;
  flex.enabled = true;
  return {{camera, camera, 0.406, 1280, 720}, Misalignment{}, flex, vibration, 1, "uav0"};
}

VibrationConfig Psd() {
  VibrationConfig vibration;
  vibration.source = VibrationSource::kPsd;
  return vibration;
}

VibrationConfig Category24() {
  VibrationConfig vibration = Psd();
  vibration.preset = VibrationPreset::kMilStd810hCat24;
  return vibration;
}

VibrationConfig Rotors() {
  VibrationConfig vibration;
  vibration.source = VibrationSource::kRotors;
  return vibration;
}

RigDrive Hovering() {
  RigDrive drive;
  drive.rotor_rate_hz = {49, 50, 51, 52};
  drive.bar = BarState{};
  return drive;
}

// A minute at 200 Hz, as long as recordings of a flight are.
VibrationConfig Recorded() {
  const std::string file = std::filesystem::temp_directory_path() / "windhover_rig_bench.csv";
  std::ofstream out(file);
  for (int i = 0; i < 12000; ++i) {
    std::array<double, 6> values;
    for (int axis = 0; axis < 6; ++axis) values[axis] = std::sin(0.7 * i * i + axis);
    out << fmt::format("{:.3f},{}\n", i / 200.0, fmt::join(values, ","));
  }
  VibrationConfig vibration;
  vibration.source = VibrationSource::kRecorded;
  vibration.file = {file, file, ""};
  return vibration;
}

void At(benchmark::State& state, const VibrationConfig& vibration) {
  const RigMotion motion = Motion(vibration);
  RigDrive drive = Hovering();
  for (auto _ : state) {
    drive.start_s += 0.0037;
    benchmark::DoNotOptimize(motion.At(drive.start_s, drive));
  }
}
BENCHMARK_CAPTURE(At, psd, Psd());
BENCHMARK_CAPTURE(At, cat24, Category24());
BENCHMARK_CAPTURE(At, rotors, Rotors());
BENCHMARK_CAPTURE(At, recorded, Recorded());

void AtMany(benchmark::State& state, const VibrationConfig& vibration) {
  const RigMotion motion = Motion(vibration);
  RigDrive drive = Hovering();
  std::vector<double> times_s(64);
  for (auto _ : state) {
    for (double& t_s : times_s) t_s = drive.start_s += 0.0001;
    benchmark::DoNotOptimize(motion.AtMany(times_s, drive));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(times_s.size()));
}
BENCHMARK_CAPTURE(AtMany, psd, Psd());
BENCHMARK_CAPTURE(AtMany, cat24, Category24());
BENCHMARK_CAPTURE(AtMany, rotors, Rotors());
BENCHMARK_CAPTURE(AtMany, recorded, Recorded());

// As many lines as a PSD's, at one instant.
void Sums(benchmark::State& state, InstructionSet instructions) {
  std::vector<Sinusoids> signals(5);
  RandomStream stream(1, "lines");
  for (std::size_t k = 0; k < signals.size(); ++k) {
    for (int i = 0; i < (k < 2 ? 512 : 128); ++i) {
      signals[k].push_back({stream.Uniform(10, 500), 1, stream.Uniform(0, 6)});
    }
  }
  for (int k = 2; k < 5; ++k) signals.push_back(signals[static_cast<std::size_t>(k)]);
  const SinusoidSums sums(signals);
  std::array<double, 8> values;
  double t_s = 0;
  for (auto _ : state) {
    sums.At(t_s += 0.0037, values.data(), instructions);
    benchmark::DoNotOptimize(values);
  }
}
BENCHMARK_CAPTURE(Sums, sse2, InstructionSet::kSse2);
BENCHMARK_CAPTURE(Sums, avx2, InstructionSet::kAvx2);
BENCHMARK_CAPTURE(Sums, avx512, InstructionSet::kAvx512);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
