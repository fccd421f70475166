#include "estimator/classical_detector.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "estimator/subpixel_match.h"

namespace windhover {
namespace {

constexpr int kCoarse = 4;  // px of the image to one px of the coarse search
constexpr int kMaxTargets = 8;
constexpr int kMinArea_px = 8;        // Coarse pixels: 128 px, half of an M200 at 40 m.
constexpr double kMinVotes = 400;     // Five coarse pixels that differ as much as orange and green.
constexpr double kMaxParallax = 0.3;  // Of the image's width: 3.4 m before the paper's rig.
constexpr int kMinParallax_px = 4;    // Coarse: 80 m before the paper's rig.
constexpr double kFragment = 0.25;    // Of the votes of a target that it lies on.
constexpr int kFineWidth_px = 200;    // Widest target that is refined at full resolution.

void CheckImages(const cv::Mat& left, const cv::Mat& right) {
  const bool good = left.type() == CV_8UC3 && right.type() == CV_8UC3 &&
                    left.size() == right.size() && left.cols >= 64 && left.rows >= 64;
  if (good) return;
  throw std::invalid_argument(fmt::format(
      "the detector needs two 8-bit RGB images of one size, at least 64 x 64 px (found {} x {} "
      "and {} x {} px)",
      left.cols, left.rows, right.cols, right.rows));
}

/// `factor`: a power of 2; halving again and again is the fastest way.
cv::Mat Shrunk(cv::Mat image, int factor) {
  for (; factor > 1; factor /= 2) {
    cv::Mat half;
    cv::resize(image, half, {image.cols / 2, image.rows / 2}, 0, 0, cv::INTER_AREA);
    image = half;
  }
  return image;
}

/// The part of the left image whose background the right image has, shifted by `shift`, too.
cv::Rect Overlap(cv::Size image, cv::Point shift) {
  const cv::Rect all({0, 0}, image);
  return all & (all + shift);
}

/// Is `segment` a weak remainder of a target that was found before it, in either image?
bool IsFragment(const Segment& segment, const std::vector<Segment>& found) {
  return std::any_of(found.begin(), found.end(), [&](const Segment& target) {
    if (segment.votes > kFragment * target.votes) return false;
    const int margin = target.box.width / 2;
    const cv::Rect surroundings(target.box.x - target.parallax_px - margin, target.box.y - margin,
                                target.box.width + target.parallax_px + 2 * margin,
                                target.box.height + 2 * margin);
    return !(segment.box & surroundings).empty();
  });
}

/// A box of pixels [x, x + width) of an image that was shrunk by `factor` from `origin` on.
image_box_t FullBox(const cv::Rect& box, int factor, cv::Point origin) {
  image_box_t full{};
  full.x_px = origin.x + factor * (box.x + box.width / 2.0) - 0.5;
  full.y_px = origin.y + factor * (box.y + box.height / 2.0) - 0.5;
  full.w_px = factor * box.width;
  full.h_px = factor * box.height;
  return full;
}

/// Around a coarse target and its image in right, inside `overlap`; sides a multiple of `factor`.
cv::Rect RefinementWindow(const Segment& coarse, const cv::Rect& overlap, int factor) {
  const cv::Rect& box = coarse.box;
  const int margin = 3 + box.width / 5;
  const int left = box.x - coarse.parallax_px - margin;
  cv::Rect window(kCoarse * left, kCoarse * (box.y - margin),
                  kCoarse * (box.br().x + margin - left), kCoarse * (box.height + 2 * margin));
  window &= overlap;
  window.width -= window.width % factor;
  window.height -= window.height % factor;
  return window;
}

}  // namespace

std::vector<stereo_box_t> ClassicalDetector::Detect(const cv::Mat& left_rgb,
                                                    const cv::Mat& right_rgb) {
  CheckImages(left_rgb, right_rgb);
  const cv::Mat left = Shrunk(left_rgb, kCoarse), right = Shrunk(right_rgb, kCoarse);
  cv::Mat left_grey, right_grey;
  cv::cvtColor(left, left_grey, cv::COLOR_RGB2GRAY);
  cv::cvtColor(right, right_grey, cv::COLOR_RGB2GRAY);
  const BackgroundShift background = AlignBackground(left_grey, right_grey);
  const cv::Rect overlap = Overlap(left.size(), background.shift_px);
  ParallaxEvidence evidence(left(overlap), right(overlap - background.shift_px),
                            /*tolerance_px=*/1);
  const int max_parallax_px = static_cast<int>(kMaxParallax * left.cols);
  std::vector<Segment> found;
  std::vector<stereo_box_t> boxes;
  for (int i = 0; i < kMaxTargets; ++i) {
    auto segment = StrongestSegment(evidence, kMinParallax_px, max_parallax_px, kMinArea_px);
    if (!segment || segment->votes < kMinVotes) break;
    evidence.Remove(segment->box, segment->parallax_px);
    if (IsFragment(*segment, found)) continue;
    found.push_back(*segment);
    segment->box += overlap.tl();
    const auto box = Refine(left_rgb, right_rgb, *segment, kCoarse * background.shift_px);
    if (box) boxes.push_back(*box);
  }
  return boxes;
}

std::optional<stereo_box_t> ClassicalDetector::Refine(const cv::Mat& left_rgb,
                                                      const cv::Mat& right_rgb,
                                                      const Segment& coarse,
                                                      cv::Point background_shift_px) const {
  const int width_px = kCoarse * coarse.box.width;
  const int factor = width_px <= kFineWidth_px ? 1 : width_px <= 2 * kFineWidth_px ? 2 : 4;
  const cv::Rect window =
      RefinementWindow(coarse, Overlap(left_rgb.size(), background_shift_px), factor);
  const cv::Mat left = Shrunk(left_rgb(window), factor);
  const cv::Mat right = Shrunk(right_rgb(window - background_shift_px), factor);
  const int to_fine = kCoarse / factor;
  const ParallaxEvidence evidence(left, right, /*tolerance_px=*/std::max(1, 3 / factor));
  const int parallax_px = to_fine * coarse.parallax_px;
  const auto segment = StrongestSegment(evidence, parallax_px - to_fine, parallax_px + to_fine,
                                        kMinArea_px * to_fine);
  if (!segment) return std::nullopt;
  const auto shift =
      MatchSubpixel(left, right, segment->box, segment->support, {segment->parallax_px, 0});
  if (!shift) return std::nullopt;
  stereo_box_t box{};
  box.left = box.right = FullBox(segment->box, factor, window.tl());
  box.right.x_px -= background_shift_px.x + factor * shift->x;
  box.right.y_px -= background_shift_px.y + factor * shift->y;
  box.score = coarse.votes / (coarse.votes + 1000);
  return box;
}

}  // namespace windhover
