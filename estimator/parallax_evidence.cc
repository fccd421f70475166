#include "estimator/parallax_evidence.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

constexpr int kClear = 24;  // Least difference, summed over RGB, that is not noise.
constexpr std::size_t kMaxVoters = 3000;
constexpr int kEnough = 90;  // More evidence of one pixel does not count.

int Outside(int value, int low, int high) { return std::max({0, low - value, value - high}); }

/// By how much a pixel leaves [low, high], summed over RGB.
int Outside(const uchar* rgb, const uchar* low, const uchar* high) {
  return Outside(rgb[0], low[0], high[0]) + Outside(rgb[1], low[1], high[1]) +
         Outside(rgb[2], low[2], high[2]);
}

/// By how much each pixel of `image` leaves [low, high], summed over RGB; saturates at 255.
cv::Mat Unexplained(const cv::Mat& image, const cv::Mat& low, const cv::Mat& high) {
  cv::Mat summed(image.size(), CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    const uchar *rgb = image.ptr(y), *least = low.ptr(y), *most = high.ptr(y);
    uchar* const sums = summed.ptr(y);
    for (int x = 0; x < image.cols; ++x) {
      sums[x] =
          static_cast<uchar>(std::min(255, Outside(rgb + 3 * x, least + 3 * x, most + 3 * x)));
    }
  }
  return summed;
}

}  // namespace

ParallaxEvidence::ParallaxEvidence(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                   int tolerance_px)
    : left_rgb_(left_rgb), right_rgb_(right_rgb) {
  const auto around = [](int radius) {
    return cv::getStructuringElement(cv::MORPH_RECT, {2 * radius + 1, 2 * radius + 1});
  };
  cv::Mat low, high;
  cv::erode(right_rgb, low, around(tolerance_px));
  cv::dilate(right_rgb, high, around(tolerance_px));
  left_evidence_ = Unexplained(left_rgb, low, high);
  cv::erode(left_rgb, low, around(tolerance_px));
  cv::dilate(left_rgb, high, around(tolerance_px));
  right_evidence_ = Unexplained(right_rgb, low, high);
  // The target itself is matched to within a pixel, whatever the background does.
  cv::erode(right_rgb, right_low_, around(1));
  cv::dilate(right_rgb, right_high_, around(1));
  ListVoters();
}

void ParallaxEvidence::ListVoters() {
  voters_.clear();
  for (int y = 0; y < left_evidence_.rows; ++y) {
    const uchar* evidence = left_evidence_.ptr<uchar>(y);
    for (int x = 0; x < left_evidence_.cols; ++x) {
      if (evidence[x] >= kClear) voters_.emplace_back(x, y);
    }
  }
  const std::size_t step = voters_.size() / kMaxVoters + 1;
  pixels_per_voter_ = static_cast<int>(step);
  for (std::size_t i = 0; i * step < voters_.size(); ++i) voters_[i] = voters_[i * step];
  voters_.resize((voters_.size() + step - 1) / step);
}

/// Row y of all that decides votes.
struct ParallaxEvidence::Rows {
  const uchar *left_evidence, *right_evidence, *left_rgb, *right_low, *right_high;

  Rows(const ParallaxEvidence& all, int y)
      : left_evidence(all.left_evidence_.ptr(y)),
        right_evidence(all.right_evidence_.ptr(y)),
        left_rgb(all.left_rgb_.ptr(y)),
        right_low(all.right_low_.ptr(y)),
        right_high(all.right_high_.ptr(y)) {}

  int VoteOf(int x, int d) const {
    const int evidence = std::min(
        {static_cast<int>(left_evidence[x]), static_cast<int>(right_evidence[x - d]), kEnough});
    if (evidence < kClear) return 0;
    const int at = 3 * (x - d);
    return std::max(0, evidence - 2 * Outside(left_rgb + 3 * x, right_low + at, right_high + at));
  }
};

std::vector<double> ParallaxEvidence::Votes(int low, int high) const {
  std::vector<int> votes(static_cast<std::size_t>(std::max(0, high - low + 1)));
  // What a voter meets lies side by side.
  for (const cv::Point& voter : voters_) {
    const Rows rows(*this, voter.y);
    for (int d = low; d <= std::min(high, voter.x); ++d) {
      votes[static_cast<std::size_t>(d - low)] += rows.VoteOf(voter.x, d);
    }
  }
  std::vector<double> all;
  for (const int sum : votes) all.push_back(static_cast<double>(sum) * pixels_per_voter_);
  return all;
}

cv::Mat ParallaxEvidence::Support(int d) const {
  cv::Mat support = cv::Mat::zeros(left_evidence_.size(), CV_8U);
  for (int y = 0; y < support.rows; ++y) {
    const Rows rows(*this, y);
    uchar* const supports = support.ptr(y);
    for (int x = d; x < support.cols; ++x) {
      if (rows.VoteOf(x, d) > 0) supports[x] = 255;
    }
  }
  return support;
}

void ParallaxEvidence::Remove(const cv::Rect& left, int d) {
  const cv::Rect all({0, 0}, left_evidence_.size());
  left_evidence_(left & all).setTo(0);
  right_evidence_((left - cv::Point(d, 0)) & all).setTo(0);
  ListVoters();
}

}  // namespace windhover
