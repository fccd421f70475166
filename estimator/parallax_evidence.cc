#include "estimator/parallax_evidence.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

constexpr int kClear = 24;  // Least difference, summed over RGB, that is not noise.
constexpr std::size_t kMaxVoters = 3000;
constexpr int kEnough = 90;  // More evidence of one pixel does not count.

/// By how much each pixel of `image` leaves [low, high], summed over RGB; saturates at 255.
cv::Mat Unexplained(const cv::Mat& image, const cv::Mat& low, const cv::Mat& high) {
  cv::Mat below, above;
  cv::subtract(low, image, below);  // Saturates at 0.
  cv::subtract(image, high, above);
  const cv::Mat outside = below + above;
  cv::Mat summed;
  cv::transform(outside, summed, cv::Matx13f(1, 1, 1));
  return summed;
}

int Outside(int value, int low, int high) { return std::max({0, low - value, value - high}); }

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

int ParallaxEvidence::VoteOf(int x, int y, int d) const {
  const int evidence = std::min({static_cast<int>(left_evidence_.at<uchar>(y, x)),
                                 static_cast<int>(right_evidence_.at<uchar>(y, x - d)), kEnough});
  if (evidence < kClear) return 0;
  const auto& left = left_rgb_.at<cv::Vec3b>(y, x);
  const auto& low = right_low_.at<cv::Vec3b>(y, x - d);
  const auto& high = right_high_.at<cv::Vec3b>(y, x - d);
  const int difference = Outside(left[0], low[0], high[0]) + Outside(left[1], low[1], high[1]) +
                         Outside(left[2], low[2], high[2]);
  return std::max(0, evidence - 2 * difference);
}

double ParallaxEvidence::Votes(int d) const {
  int votes = 0;
  for (const cv::Point& voter : voters_) {
    if (voter.x >= d) votes += VoteOf(voter.x, voter.y, d);
  }
  return static_cast<double>(votes) * pixels_per_voter_;
}

cv::Mat ParallaxEvidence::Support(int d) const {
  cv::Mat support = cv::Mat::zeros(left_evidence_.size(), CV_8U);
  for (int y = 0; y < support.rows; ++y) {
    for (int x = d; x < support.cols; ++x) {
      if (VoteOf(x, y, d) > 0) support.at<uchar>(y, x) = 255;
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
