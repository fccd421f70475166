#pragma once

#include <opencv2/core.hpp>

#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// Moves both boxes of a target, each half the way, to where what they hold looks most alike:
/// disparity is a difference, of which pixels say more than two boxes that each err for themselves.
/// Compares pixels of the images or, of boxes longer than 96 px, means of them (MatchSubpixel); if
/// that leads more than 8 of them away, boxes stay as they are. Sizes stay in any case.
/// @param left_rgb, right_rgb 8-bit RGB.
void AlignBoxes(const cv::Mat& left_rgb, const cv::Mat& right_rgb, stereo_box_t* boxes);

}  // namespace windhover
