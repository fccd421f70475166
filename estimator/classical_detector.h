#pragma once

#include <vector>

#include "estimator/detector.h"

namespace windhover {

/// Finds aircraft without learning.
class ClassicalDetector final : public Detector {
 public:
  std::vector<stereo_box_t> Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) override;
};

}  // namespace windhover
