#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "learn/detector/train_detector.h"

namespace windhover {

/// What `windhover train detector` is asked for.
struct TrainDetectorOptions {
  std::string scenario = std::string(WINDHOVER_SCENARIOS_DIR) + "/presets/calibrated.yaml";
  std::string out, state, from, first, second, labelled;
  double labelled_share = 0.5;
  std::vector<std::string> panoramas, photos;
  DetectorRecipe recipe;
  std::uint64_t data_seed = 1;
  int batch = 32, crop_px = 128, whole_every = 10, threads = 1;
  std::optional<double> minutes;
  bool resume = false;
};

/// Whether it learns the second look.
bool IsRefiner(const TrainDetectorOptions& options);

void AddTrainDetectorOptions(CLI::App* app, TrainDetectorOptions* options);

/// @throws ConfigError of options that do not go together.
void CheckTrainDetectorOptions(const TrainDetectorOptions& options);

}  // namespace windhover
