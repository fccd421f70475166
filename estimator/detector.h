#pragma once

#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "lcmtypes/stereo_box_t.hpp"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Finds aircraft in a stereo pair.
class Detector {
 public:
  virtual ~Detector() = default;

  /// Boxes of the aircraft that both images show, best first. Images are RGB, 8 bit, of one
  /// size; a pair is judged by itself, so the answer does not depend on what came before.
  virtual std::vector<stereo_box_t> Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) = 0;
};

/// The detector of a scenario (`estimator.detector` and `detector_model`).
/// @throws std::invalid_argument for a name that is none, ConfigError for a card or weights that
/// cannot be used.
std::unique_ptr<Detector> MakeDetector(const EstimatorConfig& config);

/// Reads all that MakeDetector() would and prepares nothing. @throws as that does.
void CheckDetector(const EstimatorConfig& config);

}  // namespace windhover
