#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/core.hpp>

#include "common/random/random_stream.h"

namespace windhover {

inline constexpr int kWidth_px = 640, kHeight_px = 360;  ///< Of the images.

/// Four round blotches, two colours, within ± `size_px` / 2 of (x, y), before `background`.
inline cv::Mat Image(double x, double y, double size_px, const cv::Mat& background) {
  constexpr double kPlaces[4][2] = {{-0.36, -0.14}, {0.37, -0.1}, {-0.08, 0.06}, {0.2, 0.2}};
  cv::Mat image = background.clone();
  const double sigma_px = 0.07 * size_px;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      double opacity = 0;
      for (const auto& [px, py] : kPlaces) {
        const double du = u - x - px * size_px, dv = v - y - py * size_px;
        opacity += std::exp(-(du * du + dv * dv) / (2 * sigma_px * sigma_px));
      }
      opacity = std::min(opacity, 1.0);
      auto& pixel = image.at<cv::Vec3b>(v, u);
      const cv::Vec3d colour(opacity > 0.5 ? 210 : 30, 40, 30);
      pixel = cv::Vec3d(pixel) * (1 - opacity) + colour * opacity;
    }
  }
  return image;
}

/// One colour.
inline cv::Mat Sky() { return {kHeight_px, kWidth_px, CV_8UC3, cv::Scalar(150, 180, 220)}; }

/// Unlike everywhere, of a contrast of ± `contrast`.
inline cv::Mat Leaves(double contrast, std::uint64_t seed) {
  RandomStream random(seed, "leaves");
  cv::Mat image = Sky();
  for (auto& pixel : cv::Mat_<cv::Vec3b>(image)) {
    pixel = cv::Vec3d::all(150 + random.Uniform(-contrast, contrast));
  }
  return image;
}

}  // namespace windhover
