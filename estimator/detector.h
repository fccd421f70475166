#pragma once

#include <memory>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// Finds aircraft in a stereo pair.
class Detector {
 public:
  virtual ~Detector() = default;

  /// Boxes of the aircraft that both images show, best first. Images are RGB, 8 bit, of one
  /// size; a pair is judged by itself, so the answer does not depend on what came before.
  virtual std::vector<stereo_box_t> Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) = 0;
};

/// The detector that scenarios call `name` (`estimator.detector`).
/// @throws std::invalid_argument for a name that is none.
std::unique_ptr<Detector> MakeDetector(const std::string& name);

}  // namespace windhover
