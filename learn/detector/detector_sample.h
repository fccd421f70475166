#pragma once

#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "lcmtypes/image_box_t.hpp"

namespace windhover {

/// What a detector learns from: a picture as the network gets it, and the aircraft in it.
struct DetectorSample {
  cv::Mat rgb;                     ///< 8 bit, 3 channels (red, green, blue), rows from the top.
  std::optional<image_box_t> box;  ///< Visible box, px of `rgb`, cut at its borders; or nothing.
};

/// An endless stream of batches.
class DetectorSampleSource {
 public:
  virtual ~DetectorSampleSource() = default;

  /// The batch of a step (from 0): a function of the source and the step alone, so that a training
  /// that was stopped goes on to the same weights. All pictures of a batch have one size. Steps
  /// that follow each other are cheap; going back may be slow.
  virtual std::vector<DetectorSample> Batch(int step) = 0;
};

}  // namespace windhover
