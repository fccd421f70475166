#include "render/benchmark_scene.h"

#include <algorithm>
#include <cmath>

namespace windhover {

Scenario BenchmarkScenario() {
  Scenario scenario;
  scenario.observe = Observe::kImage;
  scenario.rig.calibrated.distortion.k1 = -0.1;
  scenario.rig.misalignment.offset_px = 70;
  scenario.aircraft.resize(2);
  scenario.aircraft[0].self.carries_rig = true;
  scenario.aircraft[1].self.id = 1;
  return scenario;
}

Scenario BlurredBenchmarkScenario() {
  Scenario scenario = BenchmarkScenario();
  scenario.exposure.duration_ms = 3;
  scenario.exposure.max_samples = 9;  // Parts are odd in number; less than 0.6 px each.
  scenario.exposure.max_blur_px = 0.5;
  return scenario;
}

world_truth_t BenchmarkWorld(int pose) {
  const BenchmarkPose place = BenchmarkPoseAt(pose);
  world_truth_t world{};
  world.n_uavs = 2;
  world.uavs.resize(2, uav_truth_t{});
  world.uavs[0].qw = 1;
  world.uavs[1].id = 1;
  std::copy(place.p_WB_m.begin(), place.p_WB_m.end(), world.uavs[1].p_WB_m);
  world.uavs[1].qw = std::cos(place.yaw_rad / 2);
  world.uavs[1].qz = std::sin(place.yaw_rad / 2);
  for (int rotor = 0; rotor < 4; ++rotor) {
    world.uavs[1].rotor_rate_hz[rotor] = 49 + rotor;
    world.uavs[1].rotor_phase_rev[rotor] = 0.1 * pose + 0.07 * rotor;
  }
  return world;
}

world_truth_t BlurredBenchmarkWorld(int pose) {
  world_truth_t world = BenchmarkWorld(pose);
  world.uavs[0].w_WB_B_radps[0] = 0.5;
  world.uavs[0].w_WB_B_radps[2] = 0.5;
  return world;
}

world_truth_t EmptyBenchmarkWorld() {
  world_truth_t world = BenchmarkWorld(0);
  world.uavs[1].p_WB_m[0] = -50;
  return world;
}

}  // namespace windhover
