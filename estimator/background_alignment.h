#pragma once

#include <opencv2/core.hpp>

namespace windhover {

/// How far the far background of the right image is shifted: what left shows at q, right shows
/// at q - shift.
struct BackgroundShift {
  cv::Point shift_px;
  /// Image cells (of 40) whose texture had a say. With fewer than 8 the background is plain, and
  /// the shift 0: any lays plain on plain, but the best would lay a target on itself.
  int n_textured_cells = 0;
};

/// Finds the shift by which most cells of two 8-bit grey images of one size agree, each cell
/// with one vote, so that neither a large target nor one strong edge decides. Searches ±11 % of
/// the width and ±5 % of the height: rigs are misaligned by less.
BackgroundShift AlignBackground(const cv::Mat& left_grey, const cv::Mat& right_grey);

}  // namespace windhover
