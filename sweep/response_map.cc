#include "sweep/response_map.h"

#include <cmath>

namespace windhover {
namespace {

using Eigen::Index;

/// One cell of the map, corners in order (0,0), (1,0), (1,1), (0,1).
struct Cell {
  double x, y, width, height;
  std::array<double, 4> values;
};

/// Where the level crosses edge `e`, between corners e and e + 1.
std::optional<std::array<double, 2>> Crossing(const Cell& cell, std::size_t e, double level) {
  const double a = cell.values[e] - level, b = cell.values[(e + 1) % 4] - level;
  if ((a < 0) == (b < 0)) return std::nullopt;
  const double t = a / (a - b);
  constexpr std::array<std::array<double, 2>, 4> kCorners = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  const auto& from = kCorners[e];
  const auto& to = kCorners[(e + 1) % 4];
  return std::array{cell.x + cell.width * (from[0] + t * (to[0] - from[0])),
                    cell.y + cell.height * (from[1] + t * (to[1] - from[1]))};
}

void AddSegments(const Cell& cell, double level, std::vector<ContourSegment>* segments) {
  std::vector<std::array<double, 2>> ends;
  for (std::size_t e = 0; e < 4; ++e) {
    if (const auto end = Crossing(cell, e, level)) ends.push_back(*end);
  }
  const auto add = [&](std::size_t a, std::size_t b) {
    segments->push_back({ends[a][0], ends[a][1], ends[b][0], ends[b][1]});
  };
  if (ends.size() == 2) add(0, 1);
  if (ends.size() != 4) return;
  const double mean =
      (cell.values[0] + cell.values[1] + cell.values[2] + cell.values[3]) / 4 - level;
  const bool joins_first = (mean < 0) == (cell.values[0] - level < 0);
  add(0, joins_first ? 1 : 3);
  add(joins_first ? 2 : 1, joins_first ? 3 : 2);
}

}  // namespace

ResponseMap MakeMap(int n_x, int n_y, const std::function<double(double, double)>& f) {
  ResponseMap map{Eigen::MatrixXd(n_x, n_y)};
  for (int i = 0; i < n_x; ++i) {
    for (int j = 0; j < n_y; ++j) map.values(i, j) = f(i / (n_x - 1.0), j / (n_y - 1.0));
  }
  return map;
}

std::vector<ContourSegment> ContourOf(const ResponseMap& map, double level) {
  std::vector<ContourSegment> segments;
  const Index n_x = map.values.rows(), n_y = map.values.cols();
  const double width = 1.0 / static_cast<double>(n_x - 1);
  const double height = 1.0 / static_cast<double>(n_y - 1);
  for (Index i = 0; i + 1 < n_x; ++i) {
    for (Index j = 0; j + 1 < n_y; ++j) {
      AddSegments({static_cast<double>(i) * width,
                   static_cast<double>(j) * height,
                   width,
                   height,
                   {map.values(i, j), map.values(i + 1, j), map.values(i + 1, j + 1),
                    map.values(i, j + 1)}},
                  level, &segments);
    }
  }
  return segments;
}

std::optional<double> LargestWithin(const std::function<double(double)>& f, double limit, int n) {
  double before = f(0);
  if (before > limit) return std::nullopt;
  for (int i = 1; i <= n; ++i) {
    const double now = f(static_cast<double>(i) / n);
    if (now > limit) return (i - 1 + (limit - before) / (now - before)) / n;
    before = now;
  }
  return 1;
}

}  // namespace windhover
