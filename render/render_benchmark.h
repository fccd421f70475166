#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "scenarios/render_config.h"

namespace windhover {

struct RenderBenchmarkPlan {
  Rasteriser rasteriser = Rasteriser::kOsMesa;
  int threads = 1;
  int rounds = 10;
};

/// What a stereo pair costs: rows `background` (surroundings and noise), `full` (with the target),
/// `blurred` (nine parts of an exposure) and `two_processes`, in the least of several rounds
/// over the poses of BenchmarkWorld; processes take turns, so that a busy machine troubles all
/// alike. Times are in ms a pair, memory in MiB; CPU times are of all threads.
/// @throws std::runtime_error if a process of it fails.
nlohmann::ordered_json RunRenderBenchmark(const RenderBenchmarkPlan& plan);

/// The same as a table for people.
std::string RenderBenchmarkText(const nlohmann::ordered_json& result);

}  // namespace windhover
