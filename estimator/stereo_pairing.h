#pragma once

#include <utility>
#include <vector>

#include <opencv2/core/types.hpp>

#include "network/box_decoding.h"

namespace windhover {

/// How far boxes of one target may differ between the images of a rig whose cameras look in one
/// direction, as they come from a detector.
struct PairingLimits {
  double rows_of_image = 0.02;  ///< Rows that the centres may differ by, of the image's height, ...
  double rows_of_box = 0.5;     ///< ... and on top of it, of the mean of the boxes' heights.
  double size_ratio = 1.6;      ///< Of the widths, and of the heights.
  double against_parallax = 0.02;  ///< Of the image's width, by which left may be left of right.
};

/// Boxes of left and right that are images of one target by these limits (their epipolar lines
/// are rows), each at most once: of several, those that differ least. Indices into `left` and
/// `right`, in the order of `left`.
std::vector<std::pair<std::size_t, std::size_t>> PairBoxes(const std::vector<ScoredBox>& left,
                                                           const std::vector<ScoredBox>& right,
                                                           cv::Size image,
                                                           const PairingLimits& limits = {});

}  // namespace windhover
