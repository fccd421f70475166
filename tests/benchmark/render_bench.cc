#include <array>
#include <vector>

#include <benchmark/benchmark.h>

#include "common/geometry/rotation.h"
#include "render/benchmark_scene.h"
#include "render/box_detector.h"
#include "render/eye_image.h"
#include "render/stereo_renderer.h"

namespace windhover {
namespace {

// One iteration is one stereo pair; the 16 poses take turns.
void BM_StereoPair(benchmark::State& state) {
  Scenario scenario = BenchmarkScenario();
  if (state.range(1) > 1) {  // Turning so that the exposure needs that many parts.
    scenario.exposure.max_samples = static_cast<int>(state.range(1));
    scenario.exposure.max_blur_px = 0.01;
  }
  StereoRenderer renderer(scenario, {0}, static_cast<int>(state.range(0)));
  std::array<world_truth_t, kBenchmarkPoses> worlds;
  for (int i = 0; i < kBenchmarkPoses; ++i) {
    worlds[static_cast<std::size_t>(i)] = BenchmarkWorld(i);
    if (state.range(1) > 1) worlds[static_cast<std::size_t>(i)].uavs[0].w_WB_B_radps[2] = 0.1;
    renderer.Render(worlds[static_cast<std::size_t>(i)], i);
  }
  int i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        renderer.Render(worlds[static_cast<std::size_t>(i % kBenchmarkPoses)], i));
    ++i;
  }
  state.counters["pairs/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK(BM_StereoPair)
    ->ArgNames({"threads", "exposures"})
    ->Args({1, 1})
    ->Args({2, 1})
    ->Args({1, 5})
    ->Args({2, 5})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// The rig of scenarios/presets/uavde_12mm.yaml in flight: how many parts an exposure needs.
void BM_VibratingPair(benchmark::State& state) {
  Scenario scenario = BenchmarkScenario();
  scenario.vibration.source = VibrationSource::kPsd;
  scenario.flex.enabled = true;
  scenario.flex.frequency_hz = 62;
  scenario.flex.damping = 0.04;
  scenario.exposure.duration_ms = 3;
  StereoRenderer renderer(scenario, {0}, static_cast<int>(state.range(0)));
  const SceneGeometry geometry(scenario, {0});
  renderer.Render(BenchmarkWorld(0), 0);
  double exposures = 0;
  int i = 0;
  for (auto _ : state) {
    world_truth_t world = BenchmarkWorld(i % kBenchmarkPoses);
    world.utime = 50'000 * i;
    benchmark::DoNotOptimize(renderer.Render(world, i++));
    exposures += static_cast<double>(
        PlanExposure(scenario.exposure, scenario.exposure.duration_ms * 1e-3, world, 0,
                     geometry.Observers()[0].motion, scenario.rig.calibrated.FocalPx())
            .offsets_s.size());
  }
  state.counters["exposures"] = exposures / static_cast<double>(state.iterations());
}
BENCHMARK(BM_VibratingPair)
    ->ArgName("threads")
    ->Arg(1)
    ->Arg(2)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// Background and sensor of one pair, without targets.
void BM_Background(benchmark::State& state) {
  Scenario scenario = BenchmarkScenario();
  scenario.sensor.noise = state.range(0) != 0;
  StereoRenderer renderer(scenario, {0}, 1);
  const world_truth_t world = EmptyBenchmarkWorld();
  renderer.Render(world, 0);
  for (auto _ : state) benchmark::DoNotOptimize(renderer.Render(world, 1));
}
BENCHMARK(BM_Background)->ArgName("noise")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// The target alone, both eyes, at one distance.
void BM_Target(benchmark::State& state) {
  const Scenario scenario = BenchmarkScenario();
  const SceneGeometry geometry(scenario, {0});
  const AircraftShape& shape = geometry.ShapeOf(1);
  const PreparedModel model(shape.model, shape.radius_m);
  const auto environment = MakeEnvironment(scenario.environment);
  const SkyLight light(scenario.environment, *environment);
  const auto rasteriser = static_cast<Rasteriser>(state.range(1));
  const auto pass = MakeTargetPass(rasteriser, scenario.exposure.max_blur_px);
  const AnyCamera camera = scenario.rig.calibrated.ToStereoRig().left;
  const auto depth_m = static_cast<double>(state.range(0));
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  X_CB.linear() = R_BC_Forward().transpose();
  X_CB.translation().z() = depth_m;
  // Moved across the image by a quarter of a pixel from each time sample to the next.
  std::vector<Eigen::Isometry3d> poses(static_cast<std::size_t>(state.range(2)), X_CB);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].translation().x() += 0.25 * static_cast<double>(i) * depth_m / camera.fx_px();
  }
  const RotorTurning rotors{.phase_rev = {}, .rate_hz = {49, 50, 51, 52}, .duration_s = 2e-3};
  const DetailLevel& level = model.LevelFor(depth_m, camera.fx_px());
  for (auto _ : state) {
    const ShadedTarget shaded = Shade(model, level, Eigen::Matrix3d::Identity(), light);
    for (int eye = 0; eye < 2; ++eye) {
      benchmark::DoNotOptimize(pass->Draw(shaded, camera, 1280, 720, poses, rotors));
    }
  }
  state.counters["triangles"] = static_cast<double>(level.body.triangles.size());
}
BENCHMARK(BM_Target)
    ->ArgNames({"depth_m", "native", "times"})
    ->ArgsProduct({{5, 10, 20, 40, 80}, {0, 1}, {1, 8}})
    ->Unit(benchmark::kMillisecond);

// One row of 1280 px, as a slightly rolled camera sees it.
void BM_WarpRow(benchmark::State& state) {
  MapWindow window;
  window.Resize(1536, 128);
  const std::vector<Texel> texels(1536, Texel{15000, 10000, 5000});
  for (int row = 0; row < 128; ++row) window.SetRow(row, texels.data());
  std::vector<std::int32_t> u, v;
  for (int i = 0; i <= 1280 / kWarpCell_px; ++i) {
    u.push_back(100 * 65536 + i * 891'000);
    v.push_back(50 * 65536 + i * 18'000);
  }
  std::vector<std::uint16_t> row(1280 * 3 + kRowMargin);
  const auto isa = static_cast<InstructionSet>(state.range(0));
  for (auto _ : state) {
    WarpRow(window, {u.data(), v.data(), 1280}, row.data(), isa);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_WarpRow)->ArgName("isa")->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kNanosecond);

// One row of 1280 px of half-bright light.
void BM_SensorRow(benchmark::State& state) {
  const Sensor sensor(SensorConfig{.noise = state.range(0) != 0});
  std::vector<std::uint16_t> row(1280 * 3, 30000);
  std::vector<std::uint8_t> bytes(row.size());
  int y = 0;
  for (auto _ : state) {
    sensor.Expose({.key = {1, 0, 0, 1}, .exposure_s = 2e-3}, y++ % 720, 3840, row.data());
    sensor.Transfer(row.data(), 3840, bytes.data());
    benchmark::ClobberMemory();
  }
}
BENCHMARK(BM_SensorRow)->ArgName("noise")->Arg(0)->Arg(1)->Unit(benchmark::kNanosecond);

void BM_GeometricFrame(benchmark::State& state) {
  Scenario scenario = BenchmarkScenario();
  const SceneGeometry geometry(scenario, {0});
  const world_truth_t world = BenchmarkWorld(7);
  int tick = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        DetectGeometric(geometry.Annotate(world, 0), scenario.geometric, 1, tick++, 1280, 720));
  }
}
BENCHMARK(BM_GeometricFrame)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
