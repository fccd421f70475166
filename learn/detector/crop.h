#pragma once

#include <optional>

#include <opencv2/core/mat.hpp>

#include "common/random/random_stream.h"
#include "learn/detector/detector_sample.h"

namespace windhover {

/// The part of `sample` of that size whose upper left pixel is (left_px, top_px), which lies within
/// it; its box cut at the new borders. Nothing, if less than `least_share` of the box's area is
/// left, but some: that would teach neither what is an aircraft nor what is none.
std::optional<DetectorSample> Cropped(const DetectorSample& sample, int left_px, int top_px,
                                      cv::Size size, double least_share);

/// A crop somewhere within `sample`: one that shows its box, whole or to 60 % at least, evenly over
/// the places where it does; or, unless `shows_box`, one that shows nothing of it. Nothing, if
/// there is no such place or none was found.
std::optional<DetectorSample> RandomCrop(const DetectorSample& sample, cv::Size size,
                                         bool shows_box, RandomStream* random);

/// The sample as another camera might have seen it: mirrored half of the time, with other
/// brightness, contrast and colours, sometimes in grey, sometimes less sharp.
DetectorSample Varied(DetectorSample sample, RandomStream* random);

/// The sample mirrored left to right.
DetectorSample Mirrored(const DetectorSample& sample);

}  // namespace windhover
