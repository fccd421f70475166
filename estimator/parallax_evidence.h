#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace windhover {

/// What in a stereo pair does not belong to the far background.
///
/// Both images must be 8-bit RGB of one size, shifted so that the far background coincides. A
/// left pixel is foreground as far as no right pixel near the same place explains it, and the
/// other way round; a target stands out in both, `d` apart, and looks alike there. No colour or
/// shape is assumed, so any aircraft is found that does not have the colour of what is behind it.
class ParallaxEvidence {
 public:
  /// `tolerance_px`: how far the background may be from coinciding.
  ParallaxEvidence(const cv::Mat& left_rgb, const cv::Mat& right_rgb, int tolerance_px);

  /// Estimates from a few thousand pixels how much foreground has the parallax `d` px (left minus
  /// right): the sum over pixels of how clearly both images show it, less how differently.
  /// Element i: of `low` + i, up to `high` px.
  std::vector<double> Votes(int low, int high) const;

  /// The pixels of the left image that vote for `d`: 255, others 0.
  cv::Mat Support(int d) const;

  /// Takes the foreground inside `left`, and where the same appears in the right image, out of
  /// the evidence.
  void Remove(const cv::Rect& left, int d);

  cv::Size size() const { return left_rgb_.size(); }

 private:
  void ListVoters();
  struct Rows;

  cv::Mat left_rgb_, right_rgb_;
  cv::Mat right_low_, right_high_;          ///< Extremes of right around each pixel.
  cv::Mat left_evidence_, right_evidence_;  ///< CV_8U
  std::vector<cv::Point> voters_;           ///< Pixels of the left foreground, evenly thinned.
  int pixels_per_voter_ = 1;
};

}  // namespace windhover
