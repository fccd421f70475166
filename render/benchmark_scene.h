#pragma once

#include "lcmtypes/world_truth_t.hpp"
#include "render/benchmark_poses.h"
#include "scenarios/scenario.h"

namespace windhover {

/// A rig of 12 mm lenses, 1280 × 720 px and 0.406 m that looks at an orange M200, with distortion
/// and noise, without vibration.
Scenario BenchmarkScenario();

/// The same, exposed for 3 ms in nine parts while the rig turns (BlurredBenchmarkWorld).
Scenario BlurredBenchmarkScenario();

/// Observer and target at rest, the target at BenchmarkPoseAt(pose).
world_truth_t BenchmarkWorld(int pose);

/// The same with the observer yawing and rolling by 0.5 rad/s each: 5 px in 3 ms.
world_truth_t BlurredBenchmarkWorld(int pose);

/// The target behind the observer: surroundings and sensor alone.
world_truth_t EmptyBenchmarkWorld();

}  // namespace windhover
