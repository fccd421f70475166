#include "camera/pinhole_radtan.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/camera/camera_examples.h"

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr PinholeRadtan kBarrel{
    .fx_px = 1000, .fy_px = 1000, .cx_px = 640, .cy_px = 360, .k1 = -0.4};

TEST(PinholeRadtan, WorkedExample) {
  // x = 0.5, r² = 0.25: x' = 0.5 · (1 - 0.4 · 0.25) = 0.45, u = 1000 · 0.45 + 640.
  const auto q_px = kBarrel.Project({5, 0, 10});
  ASSERT_TRUE(q_px);
  EXPECT_DOUBLE_EQ(q_px->x(), 1090);
  EXPECT_DOUBLE_EQ(q_px->y(), 360);
}

// V3.3
TEST(PinholeRadtan, WithoutDistortionIsAPinholeExactly) {
  const PinholeRadtan camera{.fx_px = 512, .fy_px = 256, .cx_px = 100, .cy_px = 50};
  EXPECT_EQ(camera.Project({1, 2, 4}).value(), Vector2d(100 + 512 / 4, 50 + 256 / 2));
}

// The distorted radius r - 0.4 r³ peaks at r = 1 / √1.2 = 0.913, where it is 0.609.
TEST(PinholeRadtan, HasNoAnswerBeyondTheFold) {
  const double fold = 1 / std::sqrt(1.2), largest = fold * 2 / 3;
  EXPECT_TRUE(kBarrel.Project({fold - 1e-6, 0, 1}));
  EXPECT_FALSE(kBarrel.Project({fold + 1e-6, 0, 1}));
  EXPECT_FALSE(kBarrel.Project({0, -3, 1}));
  EXPECT_TRUE(kBarrel.Unproject({640 + 1000 * (largest - 1e-6), 360}));
  EXPECT_FALSE(kBarrel.Unproject({640 + 1000 * (largest + 1e-6), 360}));
}

// k1 = -0.6, k2 = 0.15: the slope 1 - 1.8 s + 0.75 s² is negative for s = r² from 0.873 to 1.527
// and positive again at s = 4, a region that is not connected to the axis.
TEST(PinholeRadtan, HasNoAnswerInARegionBehindTheFold) {
  PinholeRadtan camera = kBarrel;
  camera.k1 = -0.6;
  camera.k2 = 0.15;
  EXPECT_TRUE(camera.Project({std::sqrt(0.87), 0, 1}));
  EXPECT_FALSE(camera.Project({std::sqrt(1.2), 0, 1}));
  EXPECT_FALSE(camera.Project({2, 0, 1}));
}

TEST(PinholeRadtan, UnprojectIsRightOrEmpty) {
  std::vector<PinholeRadtan> cameras = test::ExampleCameras<PinholeRadtan>();
  cameras.push_back(kBarrel);
  test::ExpectUnprojectIsRightOrEmpty(cameras);
}

}  // namespace
}  // namespace windhover
