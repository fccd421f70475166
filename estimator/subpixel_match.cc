#include "estimator/subpixel_match.h"

#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

namespace windhover {
namespace {

constexpr int kReach_px = 8;

double SumOfSquares(const cv::Mat& left, const cv::Mat& right, const cv::Rect& box,
                    const cv::Mat& mask, cv::Point shift) {
  double sum = 0;
  int count = 0;
  for (int y = 0; y < box.height; ++y) {
    const int right_y = box.y + y - shift.y;
    if (right_y < 0 || right_y >= right.rows) continue;
    for (int x = 0; x < box.width; ++x) {
      const int right_x = box.x + x - shift.x;
      if (mask.at<uchar>(y, x) == 0 || right_x < 0 || right_x >= right.cols) continue;
      const auto& l = left.at<cv::Vec3b>(box.y + y, box.x + x);
      const auto& r = right.at<cv::Vec3b>(right_y, right_x);
      for (int c = 0; c < 3; ++c) sum += (l[c] - r[c]) * (l[c] - r[c]);
      ++count;
    }
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / count;
}

/// Where the parabola through (-1, a), (0, b), (1, c) is least; b must be.
double Vertex(double a, double b, double c) {
  const double curvature = a - 2 * b + c;
  return curvature > 0 ? 0.5 * (a - c) / curvature : 0;
}

}  // namespace

std::optional<cv::Point2d> MatchSubpixel(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                         const cv::Rect& box, const cv::Mat& mask,
                                         cv::Point start) {
  std::map<std::pair<int, int>, double> known;
  const auto cost = [&](cv::Point shift) {
    const auto [at, is_new] = known.try_emplace({shift.x, shift.y}, 0);
    if (is_new) at->second = SumOfSquares(left_rgb, right_rgb, box, mask, shift);
    return at->second;
  };
  const cv::Point steps[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  cv::Point best = start;
  for (bool moved = true; moved;) {
    moved = false;
    for (const cv::Point& step : steps) {
      if (!(cost(best + step) < cost(best))) continue;
      best += step;
      moved = true;
    }
    if (std::abs(best.x - start.x) > kReach_px || std::abs(best.y - start.y) > kReach_px) {
      return std::nullopt;
    }
  }
  const auto vertex = [&](cv::Point step) {
    return Vertex(cost(best - step), cost(best), cost(best + step));
  };
  return cv::Point2d(best.x + vertex({1, 0}), best.y + vertex({0, 1}));
}

}  // namespace windhover
