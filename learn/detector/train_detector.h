#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "learn/detector/detector_trainer.h"

namespace windhover {

struct DetectorPlan {
  DetectorRecipe recipe;
  int threads = 1;  ///< Change no bit.
  std::function<std::unique_ptr<DetectorSampleSource>()> make_source;
  std::optional<NetworkWeights> start;  ///< What training goes on from (fine-tuning).
  std::filesystem::path state_file;     ///< Where an unfinished training is kept.
  bool resume = false;                  ///< Goes on from state_file.
  int save_every = 500;                 ///< Steps between states.
  int settling_steps = 0;  ///< Batches after the last step that statistics settle on.
  nlohmann::ordered_json data;          ///< What the source is made of: whose state fits.
};

/// A point of the learning curve: means over the steps since the last one.
struct DetectorCurvePoint {
  int step;  ///< Steps done.
  double loss, box;
};

enum class DetectorTrainingEnd { kFinished, kDiverged, kInterrupted };

struct TrainedDetector {
  NetworkWeights weights;
  std::vector<DetectorCurvePoint> curve;
  int steps_done = 0;
  DetectorTrainingEnd end = DetectorTrainingEnd::kFinished;
};

/// Trains a detector. The same plan gives the same weights, interrupted or not. A training that
/// diverges ends with what it had.
/// @param on_step told after each step; false interrupts: state_file is written.
/// @throws ConfigError if state_file is asked for and is none of this training.
TrainedDetector TrainDetector(const DetectorPlan& plan,
                              const std::function<bool(int done, int total)>& on_step);

/// The losses over the steps as the content of an .svg file.
std::string DetectorCurveSvg(const std::vector<DetectorCurvePoint>& curve);

}  // namespace windhover
