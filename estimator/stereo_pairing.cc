#include "estimator/stereo_pairing.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace windhover {
namespace {

/// How much two boxes differ, in shares of the limits; nothing if beyond one of them.
std::optional<double> Difference(const image_box_t& left, const image_box_t& right, cv::Size image,
                                 const PairingLimits& limits) {
  const double most_rows =
      limits.rows_of_image * image.height + limits.rows_of_box * (left.h_px + right.h_px) / 2;
  const double rows = std::abs(left.y_px - right.y_px) / most_rows;
  const double most_ratio = std::log(limits.size_ratio);
  const double widths = std::abs(std::log(left.w_px / right.w_px)) / most_ratio;
  const double heights = std::abs(std::log(left.h_px / right.h_px)) / most_ratio;
  if (!(rows <= 1 && widths <= 1 && heights <= 1)) return {};
  if (left.x_px - right.x_px < -limits.against_parallax * image.width) return {};
  return rows + widths + heights;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> PairBoxes(const std::vector<ScoredBox>& left,
                                                           const std::vector<ScoredBox>& right,
                                                           cv::Size image,
                                                           const PairingLimits& limits) {
  struct Candidate {
    double difference;
    std::size_t left, right;
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < left.size(); ++i) {
    for (std::size_t k = 0; k < right.size(); ++k) {
      const auto difference = Difference(left[i].box, right[k].box, image, limits);
      if (difference) candidates.push_back({*difference, i, k});
    }
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.difference < b.difference; });
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const Candidate& candidate : candidates) {
    const bool taken = std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
      return pair.first == candidate.left || pair.second == candidate.right;
    });
    if (!taken) pairs.emplace_back(candidate.left, candidate.right);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace windhover
