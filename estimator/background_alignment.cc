#include "estimator/background_alignment.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

constexpr int kCellsAcross = 8, kCellsDown = 5;
constexpr int kSteps = 2;         // Halvings before the full search.
constexpr int kTruncation = 40;   // Larger differences are no worse: an occlusion.
constexpr int kFewCells = 8;      // Of kCellsAcross · kCellsDown.
constexpr float kTexture = 2.5F;  // Least spread of a cell's cost that is not noise.

/// One number of each cell, row by row.
using Cells = std::array<float, kCellsAcross * kCellsDown>;

/// Adds the truncated differences of two rows of `width` pixels to `sums`.
void AddDifferences(const uchar* left, const uchar* right, int width, std::uint16_t* sums) {
  for (int x = 0; x < width; ++x) {
    const int difference = left[x] > right[x] ? left[x] - right[x] : right[x] - left[x];
    sums[x] = static_cast<std::uint16_t>(sums[x] + std::min(difference, kTruncation));
  }
}

/// Mean truncated difference of each cell between left and right shifted by `shift`. The cells
/// cover the part of left that stays inside right for every shift up to `margin`; `columns` is
/// memory to work in.
Cells CellCosts(const cv::Mat& left, const cv::Mat& right, cv::Point shift, cv::Size margin,
                std::vector<std::uint16_t>* columns) {
  const int width = left.cols - 2 * margin.width, height = left.rows - 2 * margin.height;
  Cells cells;
  for (int down = 0; down < kCellsDown; ++down) {
    const int top = height * down / kCellsDown, bottom = height * (down + 1) / kCellsDown;
    columns->assign(static_cast<std::size_t>(width), 0);  // 1,638 rows of a cell fit.
    for (int y = margin.height + top; y < margin.height + bottom; ++y) {
      AddDifferences(left.ptr(y) + margin.width, right.ptr(y - shift.y) + margin.width - shift.x,
                     width, columns->data());
    }
    for (int across = 0; across < kCellsAcross; ++across) {
      const int begin = width * across / kCellsAcross, end = width * (across + 1) / kCellsAcross;
      const int sum = std::accumulate(columns->begin() + begin, columns->begin() + end, 0);
      const int area = std::max(1, (end - begin) * (bottom - top));
      cells[static_cast<std::size_t>(down * kCellsAcross + across)] =
          static_cast<float>(sum) / static_cast<float>(area);
    }
  }
  return cells;
}

/// The least and the most of each cell.
struct Extremes {
  Cells least, most;

  explicit Extremes(const Cells& first) : least(first), most(first) {}
  void Keep(const Cells& values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      least[i] = std::min(least[i], values[i]);
      most[i] = std::max(most[i], values[i]);
    }
  }
  float Spread(std::size_t i) const { return most[i] - least[i]; }
};

/// Each cell with texture says by which share of its spread `costs` is not its best.
double Disagreement(const Cells& costs, const Extremes& all) {
  double sum = 0;
  for (std::size_t i = 0; i < costs.size(); ++i) {
    if (all.Spread(i) > kTexture) sum += (costs[i] - all.least[i]) / (all.Spread(i) + 1e-3F);
  }
  return sum;
}

/// The best shift within `reach` of `around`.
BackgroundShift Search(const cv::Mat& left, const cv::Mat& right, cv::Point around,
                       cv::Size reach) {
  const cv::Size margin(std::abs(around.x) + reach.width, std::abs(around.y) + reach.height);
  std::vector<cv::Point> shifts;
  std::vector<Cells> costs;
  std::vector<std::uint16_t> columns;
  std::optional<Extremes> all, in_row;
  const auto keep = [&](std::optional<Extremes>* extremes) {
    if (!*extremes) extremes->emplace(costs.back());
    (*extremes)->Keep(costs.back());
  };
  for (int dy = -reach.height; dy <= reach.height; ++dy) {
    for (int dx = -reach.width; dx <= reach.width; ++dx) {
      shifts.push_back(around + cv::Point(dx, dy));
      costs.push_back(CellCosts(left, right, shifts.back(), margin, &columns));
      keep(&all);
      if (dy == 0) keep(&in_row);
    }
  }
  BackgroundShift found{around, 0};
  // Only texture across tells the shift across: a sky that brightens upwards has none.
  for (std::size_t i = 0; i < Cells{}.size(); ++i) {
    if (in_row->Spread(i) > kTexture) ++found.n_textured_cells;
  }
  double best = 1e300;
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const double disagreement = Disagreement(costs[i], *all);
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
