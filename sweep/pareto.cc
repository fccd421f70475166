#include "sweep/pareto.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace windhover {

std::vector<std::size_t> ParetoFront(const std::vector<std::array<double, 2>>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points[a] < points[b]; });
  std::vector<std::size_t> front;
  double best = std::numeric_limits<double>::infinity();
  for (const std::size_t i : order) {
    const bool is_twin = !front.empty() && points[i] == points[front.back()];
    if (!(points[i][1] < best) && !is_twin) continue;
    best = points[i][1];
    front.push_back(i);
  }
  return front;
}

}  // namespace windhover
