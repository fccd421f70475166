#include "sim/cubic_spline.h"

#include <gtest/gtest.h>

namespace windhover {
namespace {

using Eigen::Vector3d;

TEST(CubicSpline, WorkedExample) {
  // Through 0, 1, 0 at 0, 1, 2: the second derivative in the middle is -3 and the curve on the
  // way up 1.5 t - 0.5 t³.
  const CubicSpline spline({0, 1, 2}, {{0, 0, 0}, {1, 2, -1}, {0, 0, 0}});
  const auto sample = spline.At(0.5);
  EXPECT_DOUBLE_EQ(sample.value.x(), 1.5 * 0.5 - 0.5 * 0.125);
  EXPECT_DOUBLE_EQ(sample.value.y(), 2 * sample.value.x());
  EXPECT_DOUBLE_EQ(sample.first.x(), 1.5 - 1.5 * 0.25);
  EXPECT_DOUBLE_EQ(sample.second.x(), -1.5);
  EXPECT_DOUBLE_EQ(sample.third.x(), -3);
}

TEST(CubicSpline, TwoPointsAreALine) {
  const auto sample = CubicSpline({1, 3}, {{0, 0, 0}, {4, 0, 0}}).At(2.5);
  EXPECT_EQ(sample.value, Vector3d(3, 0, 0));
  EXPECT_EQ(sample.first, Vector3d(2, 0, 0));
}

TEST(CubicSpline, PassesThroughItsPointsSmoothly) {
  const std::vector<double> times_s = {0, 0.3, 1, 1.1, 2.5, 4};
  std::vector<Vector3d> points;
  for (int i = 0; i < 6; ++i) points.push_back(Vector3d::Random());
  const CubicSpline spline(times_s, points);
  for (int i = 0; i < 6; ++i) {
    EXPECT_LT((spline.At(times_s[i]).value - points[i]).norm(), 1e-12);
    if (i == 0 || i == 5) {
      EXPECT_LT(spline.At(times_s[i]).second.norm(), 1e-9);
      continue;
    }
    const auto before = spline.At(times_s[i] - 1e-9), after = spline.At(times_s[i] + 1e-9);
    // Derivatives of up to 1e3 change by 1e-6 in 1e-9.
    EXPECT_LT((before.first - after.first).norm(), 1e-5);
    EXPECT_LT((before.second - after.second).norm(), 1e-5);
  }
  for (double t_s = 0.05; t_s < 4; t_s += 0.2) {
    const double h = 1e-5;
    const auto before = spline.At(t_s - h), now = spline.At(t_s), after = spline.At(t_s + h);
    EXPECT_LT((now.first - (after.value - before.value) / (2 * h)).norm(), 1e-5);
    EXPECT_LT((now.second - (after.first - before.first) / (2 * h)).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace windhover
