// When cameras expose, how long, and what becomes of a point.

#include "rig/exposure.h"

#include <cmath>

#include <gtest/gtest.h>

#include "camera/pinhole_radtan.h"
#include "common/geometry/rotation.h"
#include "render/auto_exposure.h"
#include "render/point_spread.h"
#include "render/row_poses.h"
#include "rig/optics.h"

namespace windhover {
namespace {

StereoShutterTimes TimesAt(const ExposureConfig& config, std::int64_t utime_us = 0,
                           double left_s = 0.002, double right_s = 0.002) {
  return ShutterTimesAt(config, left_s, right_s, 720, 3, "uav0", utime_us);
}

TEST(ShutterTimes, AreTheFramesOwnByDefault) {
  const StereoShutterTimes times = TimesAt({}, 300'000);
  for (const ShutterTimes& camera : {times.left, times.right}) {
    EXPECT_EQ(camera.middle_s, 0);
    EXPECT_EQ(camera.RowMiddle_s(0), 0);
    EXPECT_EQ(camera.RowMiddle_s(719), 0);
  }
}

// 44 us a row: the first row of 720 is 359.5 · 44 us = 15.818 ms early.
TEST(ShutterTimes, RollFromTopToBottomAroundTheMiddle) {
  ExposureConfig config;
  config.shutter = Shutter::kRolling;
  const ShutterTimes times = TimesAt(config).left;
  EXPECT_NEAR(times.RowMiddle_s(0), -0.015818, 1e-12);
  EXPECT_NEAR(times.RowMiddle_s(719), 0.015818, 1e-12);
  EXPECT_EQ(times.RowMiddle_s(359.5), 0);
}

// Exposures start together: one of 8 ms instead of 2 has its middle 3 ms later.
TEST(ShutterTimes, StartTogetherAndSkew) {
  ExposureConfig config;
  config.skew_ms = 10;
  const StereoShutterTimes times = TimesAt(config, 0, 0.008, 0.002);
  EXPECT_NEAR(times.left.middle_s, 0.003, 1e-15);
  EXPECT_NEAR(times.right.middle_s, 0.01, 1e-15);
}

// 5000 frames know a standard deviation to 1 %, a correlation to 0.014.
TEST(ShutterTimes, JitterIndependently) {
  ExposureConfig config;
  config.jitter_ms = 2;
  double left2 = 0, right2 = 0, both = 0;
  constexpr int kFrames = 5000;
  for (int i = 0; i < kFrames; ++i) {
    const StereoShutterTimes times = TimesAt(config, i * 100'000);
    left2 += times.left.middle_s * times.left.middle_s;
    right2 += times.right.middle_s * times.right.middle_s;
    both += times.left.middle_s * times.right.middle_s;
  }
  EXPECT_NEAR(std::sqrt(left2 / kFrames), 0.002, 1e-4);
  EXPECT_NEAR(std::sqrt(right2 / kFrames), 0.002, 1e-4);
  EXPECT_LT(std::abs(both / std::sqrt(left2 * right2)), 0.06);
  EXPECT_EQ(TimesAt(config, 7).left.middle_s, TimesAt(config, 7).left.middle_s);
}

constexpr PinholeRadtan kCamera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};

// A camera that yaws at `rate_radps` in front of a body at rest, with a pose each 16 rows.
RowPoses Yawing(double rate_radps, double row_time_s) {
  RowPoses poses;
  poses.row_step_px = 16;
  for (int row = 0; row <= 720; row += 16) {
    const double t_s = (row - 359.5) * row_time_s;
    Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
    X_CB.linear() = RotationFromVector(Eigen::Vector3d(0, -rate_radps * t_s, 0));
    poses.X_CB.push_back(X_CB);
  }
  return poses;
}

// V3.7: an upright edge of h rows shears by ω f t_line h: 0.5 · 3215 · 44 us · 121 = 8.56 px.
TEST(RowPoses, ShearAnUprightEdge) {
  const RowPoses poses = Yawing(0.5, 44e-6);
  const auto top = ProjectByRows(kCamera, poses, {0, -60.5 / 3215 * 20, 20});
  const auto bottom = ProjectByRows(kCamera, poses, {0, 60.5 / 3215 * 20, 20});
  ASSERT_TRUE(top && bottom);
  // The image moves left as the camera turns right.
  EXPECT_NEAR(top->x() - bottom->x(), 8.56, 0.01);
}

TEST(RowPoses, SeeEachPointWhenItsRowIsExposed) {
  const RowPoses poses = Yawing(2, 44e-6);
  for (double y = -2; y <= 2; y += 0.37) {
    const Eigen::Vector3d p_B(0.5, y, 20);
    Eigen::Vector3d p_C;
    const auto q_px = ProjectByRows(kCamera, poses, p_B, &p_C);
    ASSERT_TRUE(q_px);
    const double t_s = (q_px->y() - 359.5) * 44e-6;
    const Eigen::Vector3d exact = RotationFromVector(Eigen::Vector3d(0, -2 * t_s, 0)) * p_B;
    // A chord over 16 rows leaves the arc by (2 rad/s · 0.7 ms)² / 8 · 20 m = 5e-6 m.
    EXPECT_LT((p_C - exact).norm(), 6e-6);
    EXPECT_LT((*q_px - *kCamera.Project(p_C)).norm(), 1e-9);
  }
}

TEST(RowPoses, OnePoseIsAGlobalShutter) {
  const RowPoses poses(Eigen::Isometry3d::Identity());
  const Eigen::Vector3d p_B(0.3, 0.2, 4);
  EXPECT_EQ(*ProjectByRows(kCamera, poses, p_B), *kCamera.Project(p_B));
  EXPECT_FALSE(ProjectByRows(kCamera, poses, {0, 0, -1}));
}

// V3.10: from 8 times too dark or too bright the error falls to 0.6 of its logarithm each frame.
TEST(AutoExposure, ConvergesInTenFrames) {
  AutoExposureConfig config;
  config.mode = AutoExposureMode::kIndependent;
  for (const double scene : {0.18 / 8, 0.18 / 2, 0.18 * 8}) {
    AutoExposure exposure(config, 0.002);
    const auto light = [&] {
      const ExposureSetting now = exposure.Setting();
      return scene * now.duration_s * now.gain / 0.002;
    };
    for (int frame = 0; frame < 10; ++frame) exposure.Observe(light());
    EXPECT_NEAR(light() / config.target, 1, 0.03) << scene;
    EXPECT_LE(exposure.Setting().duration_s, 0.010);
  }
}

TEST(AutoExposure, LengthensFirstThenAmplifies) {
  AutoExposureConfig config;
  config.mode = AutoExposureMode::kIndependent;
  AutoExposure exposure(config, 0.002);
  for (int frame = 0; frame < 3; ++frame) {
    const ExposureSetting before = exposure.Setting();
    exposure.Observe(0.09);
    const ExposureSetting after = exposure.Setting();
    // 2^0.4 = 1.32 a frame: 2, 2.6, 3.5, 4.6 ms.
    EXPECT_NEAR(after.duration_s / before.duration_s, std::pow(2, 0.4), 1e-12);
    EXPECT_EQ(after.gain, 1);
  }
  for (int frame = 0; frame < 100; ++frame) exposure.Observe(0);
  EXPECT_NEAR(exposure.Setting().duration_s, 0.010, 1e-12);
  EXPECT_NEAR(exposure.Setting().gain, 8, 1e-9);
  for (int frame = 0; frame < 100; ++frame) exposure.Observe(1);
  EXPECT_NEAR(exposure.Setting().duration_s, 50e-6, 1e-12);
}

TEST(AutoExposure, OffStaysAtTheNominalDuration) {
  AutoExposure exposure({}, 0.0021);
  exposure.Observe(0.9);
  EXPECT_EQ(exposure.Setting().duration_s, 0.0021);
  EXPECT_EQ(exposure.Setting().gain, 1);
}

// V3.11: the kernel has the spread's variance, σ² + c² / 16, and a disc ends at its radius.
TEST(PointSpread, HasTheVarianceOfDiscAndDiffraction) {
  for (const double sigma_px : {0.0, 0.173, 0.4, 1.0, 2.5}) {
    for (const double disc_px : {0.0, 0.57, 1.5, 3.7, 11.0}) {
      const PointSpread spread(sigma_px, disc_px);
      std::uint64_t sum = 0;
      for (const PointSpread::Tap& tap : spread.Taps()) sum += tap.weight;
      EXPECT_EQ(sum, 65536u);
      const double variance = sigma_px * sigma_px + disc_px * disc_px / 16;
      // A disc's edge is known to an eighth of a pixel: a few per cent of a disc of 2 px.
      EXPECT_NEAR(spread.Variance(), variance, 0.03 * variance + 1e-3)
          << sigma_px << " " << disc_px;
    }
  }
}

TEST(PointSpread, DiscEndsAtItsRadius) {
  const double diameter_px = DefocusDiameter_m(0.012, 2.8, 15, 1) / 3.7325e-6;  // 14.3 px.
  const PointSpread spread(0, diameter_px);
  for (const PointSpread::Tap& tap : spread.Taps()) {
    EXPECT_LT(std::hypot(tap.dx, tap.dy), diameter_px / 2 + std::sqrt(0.5));
  }
}

TEST(PointSpread, NothingStaysAsItIs) {
  const PointSpread spread(0, 0);
  EXPECT_TRUE(spread.IsPoint());
  const std::vector<std::uint16_t> image = {1, 2, 3, 65535, 0, 7};
  std::vector<std::uint16_t> row(6);
  SpreadRow({image.data(), 2, 1, 3}, spread, 0, row.data());
  EXPECT_EQ(row, image);
}

// Light is kept, moves nowhere, and is not lost at the borders.
TEST(PointSpread, KeepsLightAndPlace) {
  constexpr int kSize = 41;
  const PointSpread spread(0.8, 5);
  std::vector<std::uint16_t> image(kSize * kSize, 0), row(kSize);
  image[20 * kSize + 18] = 60000;
  double sum = 0, x_sum = 0, y_sum = 0;
  for (int y = 0; y < kSize; ++y) {
    SpreadRow({image.data(), kSize, kSize, 1}, spread, y, row.data());
    for (int x = 0; x < kSize; ++x) {
      const double value = row[static_cast<std::size_t>(x)];
      sum += value, x_sum += x * value, y_sum += y * value;
    }
  }
  EXPECT_NEAR(sum / 60000, 1, 1e-3);
  EXPECT_NEAR(x_sum / sum, 18, 1e-3);
  EXPECT_NEAR(y_sum / sum, 20, 1e-3);
  std::fill(image.begin(), image.end(), 65535);
  SpreadRow({image.data(), kSize, kSize, 1}, spread, 0, row.data());
  EXPECT_EQ(row, std::vector<std::uint16_t>(kSize, 65535));
}

}  // namespace
}  // namespace windhover
