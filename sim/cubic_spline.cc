#include "sim/cubic_spline.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace windhover {

using Eigen::Vector3d;

CubicSpline::CubicSpline(std::vector<double> times_s, std::vector<Vector3d> points)
    : times_s_(std::move(times_s)),
      points_(std::move(points)),
      second_(points_.size(), Vector3d::Zero()) {
  // Equal first derivatives on both sides of each inner point give a tridiagonal system for the
  // second ones; Thomas's algorithm solves it.
  const std::size_t n = points_.size();
  std::vector<double> upper(n, 0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before_s = times_s_[i] - times_s_[i - 1], after_s = times_s_[i + 1] - times_s_[i];
    const Vector3d turn =
        (points_[i + 1] - points_[i]) / after_s - (points_[i] - points_[i - 1]) / before_s;
    const double pivot = 2 * (before_s + after_s) - before_s * upper[i - 1];
    upper[i] = after_s / pivot;
    second_[i] = (6 * turn - before_s * second_[i - 1]) / pivot;
  }
  for (std::size_t i = n - 1; i-- > 1;) second_[i] -= upper[i] * second_[i + 1];
}

CubicSpline::Sample CubicSpline::At(double t_s) const {
  const auto after = std::upper_bound(times_s_.begin() + 1, times_s_.end() - 1, t_s);
  const std::size_t j = static_cast<std::size_t>(after - times_s_.begin()), i = j - 1;
  const double h = times_s_[j] - times_s_[i], u = t_s - times_s_[i];
  Sample out;
  out.third = (second_[j] - second_[i]) / h;
  const Vector3d start_slope =
      (points_[j] - points_[i]) / h - h / 6 * (2 * second_[i] + second_[j]);
  out.second = second_[i] + u * out.third;
  out.first = start_slope + u * (second_[i] + u / 2 * out.third);
  out.value = points_[i] + u * (start_slope + u / 2 * (second_[i] + u / 3 * out.third));
  return out;
}

}  // namespace windhover
