#include "estimator/box_alignment.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "estimator/subpixel_match.h"
#include "network/detector_input.h"

namespace windhover {
namespace {

// Finer costs time and gains nothing: blades that turned look different from both sides.
constexpr double kLongestSide_px = 96;
constexpr int kBorder_px = 10;  // More than MatchSubpixel() goes.

/// The middle of a box with `inner` around it and a border.
cv::Mat Around(const image_box_t& box, const cv::Mat& rgb, double scale, cv::Size inner) {
  InputWindow window;
  window.scale = scale;
  window.size = {inner.width + 2 * kBorder_px, inner.height + 2 * kBorder_px};
  window.left_px = box.x_px - scale * window.size.width / 2;
  window.top_px = box.y_px - scale * window.size.height / 2;
  return SeenThrough(window, rgb);
}

}  // namespace

void AlignBoxes(const cv::Mat& left_rgb, const cv::Mat& right_rgb, stereo_box_t* boxes) {
  image_box_t &left = boxes->left, &right = boxes->right;
  const double width_px = std::sqrt(left.w_px * right.w_px);
  const double height_px = std::sqrt(left.h_px * right.h_px);
  const double scale = std::max(1.0, std::max(width_px, height_px) / kLongestSide_px);
  const cv::Size inner(std::max(1, static_cast<int>(std::lround(width_px / scale))),
                       std::max(1, static_cast<int>(std::lround(height_px / scale))));
  const std::optional<cv::Point2d> shift =
      MatchSubpixel(Around(left, left_rgb, scale, inner), Around(right, right_rgb, scale, inner),
                    {{kBorder_px, kBorder_px}, inner}, cv::Mat(inner, CV_8UC1, cv::Scalar(1)), {});
  if (!shift) return;
  const cv::Point2d half_px = *shift * (scale / 2);
  left.x_px += half_px.x;
  left.y_px += half_px.y;
  right.x_px -= half_px.x;
  right.y_px -= half_px.y;
}

}  // namespace windhover
