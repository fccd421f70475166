#pragma once

#include <opencv2/core.hpp>

#include "lcmtypes/image_box_t.hpp"
#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// Where the other image of a rectified pair shows what `box` holds in that of `eye`: as large, in
/// the rows that PairBoxes() allows a rig, where a parallax is possible, at the place that looks
/// most alike (normalised correlation, of means of pixels if the box is longer than 32 px).
/// @param eye whose image `rgb` is: 0 left, 1 right. @param rgb, other_rgb 8-bit RGB, of one size.
image_box_t FindCounterpart(const cv::Mat& rgb, int eye, const image_box_t& box,
                            const cv::Mat& other_rgb);

/// Whether both boxes of a target are as far apart as those that FindCounterpart() was given and
/// gave, `parallax_px`: to a sixteenth of their width, twice what it sees.
bool ParallaxAgrees(const stereo_box_t& boxes, double parallax_px);

}  // namespace windhover
