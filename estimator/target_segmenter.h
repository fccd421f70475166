#pragma once

#include <optional>

#include <opencv2/core.hpp>

#include "estimator/parallax_evidence.h"

namespace windhover {

/// A target in a background-aligned pair.
struct Segment {
  cv::Rect box;     ///< In the left image.
  cv::Mat support;  ///< The target's pixels in `box`: 255.
  int parallax_px;  ///< Left minus right.
  double votes;
  int area_px;  ///< Pixels that voted.
};

/// The target whose parallax, between `low` and `high` px, has most votes; nothing if none is
/// clear. `min_area_px`: least number of voting pixels.
std::optional<Segment> StrongestSegment(const ParallaxEvidence& evidence, int low, int high,
                                        int min_area_px);

}  // namespace windhover
