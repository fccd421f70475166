#include "estimator/background_alignment.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

constexpr int kCellsAcross = 8, kCellsDown = 5;
constexpr int kSteps = 2;           // Halvings before the full search.
constexpr double kTruncation = 40;  // Larger differences are no worse: an occlusion.
constexpr int kFewCells = 8;        // Of kCellsAcross · kCellsDown.
constexpr float kTexture = 2.5F;    // Least spread of a cell's cost that is not noise.

/// Mean truncated difference of each cell between left and right shifted by `shift`. The cells
/// cover the part of left that stays inside right for every shift up to `margin`.
cv::Mat CellCosts(const cv::Mat& left, const cv::Mat& right, cv::Point shift, cv::Size margin) {
  const cv::Rect inside(margin.width, margin.height, left.cols - 2 * margin.width,
                        left.rows - 2 * margin.height);
  cv::Mat difference, cells;
  cv::absdiff(left(inside), right(inside - shift), difference);
  cv::threshold(difference, difference, kTruncation, 0, cv::THRESH_TRUNC);
  difference.convertTo(difference, CV_32F);
  cv::resize(difference, cells, {kCellsAcross, kCellsDown}, 0, 0, cv::INTER_AREA);
  return cells;
}

void KeepExtremes(const cv::Mat& values, cv::Mat* least, cv::Mat* most) {
  *least = least->empty() ? values.clone() : cv::Mat(cv::min(*least, values));
  *most = most->empty() ? values.clone() : cv::Mat(cv::max(*most, values));
}

/// The best shift within `reach` of `around`.
BackgroundShift Search(const cv::Mat& left, const cv::Mat& right, cv::Point around,
                       cv::Size reach) {
  const cv::Size margin(std::abs(around.x) + reach.width, std::abs(around.y) + reach.height);
  std::vector<cv::Point> shifts;
  std::vector<cv::Mat> costs;
  cv::Mat least, most, least_in_row, most_in_row;
  for (int dy = -reach.height; dy <= reach.height; ++dy) {
    for (int dx = -reach.width; dx <= reach.width; ++dx) {
      shifts.push_back(around + cv::Point(dx, dy));
      costs.push_back(CellCosts(left, right, shifts.back(), margin));
      if (dy == 0) KeepExtremes(costs.back(), &least_in_row, &most_in_row);
      KeepExtremes(costs.back(), &least, &most);
    }
  }
  const cv::Mat spread = most - least;
  const cv::Mat has_texture = spread > kTexture;
  // Only texture across tells the shift across: a sky that brightens upwards has none.
  const cv::Mat has_texture_across = (most_in_row - least_in_row) > kTexture;
  double best = 1e300;
  BackgroundShift found{around, cv::countNonZero(has_texture_across)};
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    cv::Mat vote = (costs[i] - least) / (spread + 1e-3F);
    const double disagreement = cv::sum(vote.setTo(0, ~has_texture))[0];
    if (disagreement >= best) continue;
    best = disagreement;
    found.shift_px = shifts[i];
  }
  return found;
}

}  // namespace

BackgroundShift AlignBackground(const cv::Mat& left_grey, const cv::Mat& right_grey) {
  std::vector<cv::Mat> left{left_grey}, right{right_grey};
  for (int i = 0; i < kSteps; ++i) {
    cv::Mat half;
    cv::resize(left.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    left.push_back(half.clone());
    cv::resize(right.back(), half, {}, 0.5, 0.5, cv::INTER_AREA);
    right.push_back(half.clone());
  }
  const cv::Mat& coarsest = left.back();
  BackgroundShift found =
      Search(left.back(), right.back(), {0, 0},
             {std::max(1, coarsest.cols * 11 / 100), std::max(1, coarsest.rows * 5 / 100)});
  if (found.n_textured_cells < kFewCells) return {{0, 0}, found.n_textured_cells};
  for (int i = kSteps - 1; i >= 0; --i) {
    const auto level = static_cast<std::size_t>(i);
    const int n_textured_cells = found.n_textured_cells;
    found = Search(left[level], right[level], 2 * found.shift_px, {1, 1});
    found.n_textured_cells = n_textured_cells;
  }
  return found;
}

}  // namespace windhover
