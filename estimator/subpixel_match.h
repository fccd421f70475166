#pragma once

#include <optional>

#include <opencv2/core.hpp>

namespace windhover {

/// The shift s near `start`, to a fraction of a pixel, at which the pixels of `left` inside
/// `box` that `mask` (of the box's size) has set look most like those of `right` at q - s:
/// downhill from `start` to the least sum of squares, then a parabola through it and its
/// neighbours in each direction.
/// @return nothing if that leads more than 8 px away.
std::optional<cv::Point2d> MatchSubpixel(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                         const cv::Rect& box, const cv::Mat& mask, cv::Point start);

}  // namespace windhover
