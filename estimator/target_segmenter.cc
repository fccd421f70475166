#include "estimator/target_segmenter.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

/// Parts of an aircraft that a gap of this share of its parallax parts are still one: 0.16 m
/// for a baseline of 0.4 m, whatever the distance.
constexpr double kGap = 0.4;

/// The connected parts of `support`, across gaps, that have most pixels.
std::optional<Segment> LargestPart(const cv::Mat& support, int d, int min_area_px) {
  const int gap_px = std::max(1, static_cast<int>(kGap * d / 2));
  cv::Mat grown, labels, stats, centroids;
  cv::dilate(support, grown,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * gap_px + 1, 2 * gap_px + 1}));
  const int n = cv::connectedComponentsWithStats(grown, labels, stats, centroids);
  Segment best{.box = {}, .support = {}, .parallax_px = d, .votes = 0, .area_px = 0};
  for (int label = 1; label < n; ++label) {
    const cv::Mat part = (labels == label) & support;
    const int area_px = cv::countNonZero(part);
    if (area_px <= best.area_px) continue;
    best.area_px = area_px;
    best.box = cv::boundingRect(part);
    best.support = part(best.box).clone();
  }
  if (best.area_px < min_area_px) return std::nullopt;
  return best;
}

}  // namespace

std::optional<Segment> StrongestSegment(const ParallaxEvidence& evidence, int low, int high,
                                        int min_area_px) {
  low = std::max(1, low);
  const std::vector<double> votes = evidence.Votes(low, std::min(high, evidence.size().width - 1));
  const auto most = std::max_element(votes.begin(), votes.end());
  if (most == votes.end() || *most <= 0) return std::nullopt;
  const double most_votes = *most;
  const int best_d = low + static_cast<int>(most - votes.begin());
  auto segment = LargestPart(evidence.Support(best_d), best_d, min_area_px);
  if (segment) segment->votes = most_votes;
  return segment;
}

}  // namespace windhover
