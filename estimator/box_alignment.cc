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
  const cv::Size size(inner.width + 2 * kBorder_px, inner.height + 2 * kBorder_px);
  return SeenThrough(WindowAround(box, scale, size), rgb);
}

}  // namespace

void AlignBoxes(const cv::Mat& left_rgb, const cv::Mat& right_rgb, stereo_box_t* boxes) {
  image_box_t &left = boxes->left, &right = boxes->right;
  image_box_t mean = left;
  mean.w_px = std::sqrt(left.w_px * right.w_px);
  mean.h_px = std::sqrt(left.h_px * right.h_px);
  const InputWindow compared = ReducedWindow(mean, kLongestSide_px);
  const double scale = compared.scale;
  const cv::Size inner = compared.size;
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
