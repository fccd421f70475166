#include "render/background.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "common/geometry/rotation.h"
#include "render/sphere_angles.h"

namespace windhover {
namespace {

constexpr int kWidth_px = 640, kHeight_px = 360;
constexpr double kFocal_px = 1600;

PinholeRadtan Camera() {
  return {.fx_px = kFocal_px,
          .fy_px = kFocal_px,
          .cx_px = 325.3,
          .cy_px = 171.8,
          .k1 = -0.25,
          .k2 = 0.4,
          .p1 = 1e-3,
          .p2 = -5e-4};
}

// A camera that looks east and somewhat up, rolled.
Eigen::Matrix3d R_WC(double yaw_deg, double pitch_deg) {
  return RotationFromVector(Eigen::Vector3d(0, 0, RadFromDeg(yaw_deg))) * R_BC_Forward() *
         RotationFromVector(Eigen::Vector3d(RadFromDeg(pitch_deg), 0, 0)) *
         RotationFromVector(Eigen::Vector3d(0, 0, RadFromDeg(3)));
}

// Light that varies over a few degrees, so that exact values are known to a small fraction.
class SmoothWorld : public Environment {
 public:
  Eigen::Vector3f Radiance(const Eigen::Vector3f& d, float) const override {
    const Eigen::Vector3f phase = d * 40;
    return {0.5f + 0.4f * std::sin(phase.x() + phase.z()), 0.5f + 0.4f * std::sin(phase.y()),
            0.5f + 0.4f * std::cos(phase.z() - phase.y())};
  }
};

// Black but for one direction: a Gaussian of 1.5 px.
class PointWorld : public Environment {
 public:
  explicit PointWorld(const Eigen::Vector3d& d_W) : d_W_(d_W) {}
  Eigen::Vector3f Radiance(const Eigen::Vector3f& d, float) const override {
    const double angle_px = (d.cast<double>() - d_W_).norm() * kFocal_px / 1.5;
    return Eigen::Vector3f::Constant(static_cast<float>(std::exp(-angle_px * angle_px / 2)));
  }

 private:
  Eigen::Vector3d d_W_;
};

struct Frame {
  std::vector<std::uint16_t> values =
      std::vector<std::uint16_t>(kWidth_px * kHeight_px * 3 + kRowMargin);
  double latitude_rad = 0;  ///< Greatest of the view, in its chart.
  double At(int x, int y, int c) const {
    return values[static_cast<std::size_t>((y * kWidth_px + x) * 3 + c)];
  }
};

// The mean of `moments` equal parts of an exposure, from the first orientation on.
Frame DrawMean(const Environment& world, const std::vector<Eigen::Matrix3d>& moments,
               int extra_texels = 0) {
  RadianceMap map(world, kFocal_px);
  const Chart chart = ChartFor(moments[0].col(2));
  const double u_near = map.PlaceOf(moments[0].col(2), chart).x();
  const RayGrid grid(Camera(), kWidth_px, kHeight_px);
  std::vector<WarpGrid> warps;
  double u_min = 1e9, u_max = -1e9, v_min = 1e9, v_max = -1e9;
  for (const Eigen::Matrix3d& R : moments) {
    warps.push_back(MakeWarpGrid(grid, {R}, map, chart, u_near));
    warps.back().share = 65536 / static_cast<std::uint32_t>(moments.size());
    u_min = std::min(u_min, warps.back().u_min), u_max = std::max(u_max, warps.back().u_max);
    v_min = std::min(v_min, warps.back().v_min), v_max = std::max(v_max, warps.back().v_max);
  }
  MapWindow window;
  map.Cover(chart, static_cast<int>(u_min) - 2 - extra_texels, static_cast<int>(u_max) + 2,
            static_cast<int>(v_min) - 2 - extra_texels, static_cast<int>(v_max) + 2, 2, &window);
  const BackgroundWarp background(grid, warps, map, window);
  Frame frame;
  const double equator = map.Width() / 4.0;
  frame.latitude_rad =
      std::max(std::abs(v_min - equator), std::abs(v_max - equator)) / map.TexelsPerRad();
  for (int y = 0; y < kHeight_px; ++y) background.Row(y, frame.values.data() + y * kWidth_px * 3);
  return frame;
}

Frame Draw(const Environment& world, const Eigen::Matrix3d& R, int extra_texels = 0) {
  return DrawMean(world, {R}, extra_texels);
}

class EveryView : public testing::TestWithParam<std::pair<double, double>> {};

// Light is interpolated between texels h = 1/1360 rad apart, off by h² / 8 |f''| = 8.6e-5 of white
// for f'' = 2 · 0.4 · 40², 5.7 of 65535; averaging it over a texel costs 1.5, and texels of
// 15 bits, weights and a white of 65532 cost 5 more.
// Places are interpolated over cells of H = 0.01 rad; a level line bends by tan(latitude), so they
// are off by H² / 8 tan(latitude), where light changes by up to 0.4 · 40 · sqrt(2) a radian.
double Tolerance(double latitude_rad) {
  return 5.7 + 1.5 + 5 +
         65535 * 0.01 * 0.01 / 8 * std::tan(latitude_rad) * 0.4 * 40 * std::sqrt(2.0);
}

// Largest difference from the mean of exact rays' light, of 65535.
double WorstOf(const Frame& frame, const SmoothWorld& world,
               const std::vector<Eigen::Matrix3d>& moments) {
  double worst = 0;
  for (int y = 0; y < kHeight_px; y += 7) {
    for (int x = 0; x < kWidth_px; x += 5) {
      Eigen::Vector3f exact = Eigen::Vector3f::Zero();
      for (const Eigen::Matrix3d& R : moments) {
        const Eigen::Vector3d d_W = R * *Camera().Unproject({x, y});
        exact += world.Radiance(d_W.cast<float>(), 0) * 65535 / static_cast<float>(moments.size());
      }
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(frame.At(x, y, c) - exact[c]));
    }
  }
  return worst;
}

TEST_P(EveryView, AgreesWithTheExactRayOfEachPixel) {
  const SmoothWorld world;
  const Eigen::Matrix3d R = R_WC(GetParam().first, GetParam().second);
  const Frame frame = Draw(world, R);
  EXPECT_LT(WorstOf(frame, world, {R}), Tolerance(frame.latitude_rad));
}

// A turn of 0.8° in four moments, half of what light takes to change: near the pole of its chart
// only the last of some may be. Weights of a share may be wrong by 1.5/32767 of neighbouring
// texels' difference, 0.02 of white here: by 1 for all.
TEST_P(EveryView, IsTheMeanOfMoments) {
  const SmoothWorld world;
  std::vector<Eigen::Matrix3d> moments;
  for (int i = 0; i < 4; ++i) {
    moments.push_back(R_WC(GetParam().first + 0.2 * i, GetParam().second - 0.1 * i));
  }
  const Frame frame = DrawMean(world, moments);
  EXPECT_LT(WorstOf(frame, world, moments), Tolerance(frame.latitude_rad) + 1);
}

TEST(BackgroundWarp, RefusesMoreMomentsThanItHasRoomFor) {
  const std::vector<Eigen::Matrix3d> moments(kMaxWarpMoments + 1, R_WC(0, 0));
  EXPECT_THROW(DrawMean(SmoothWorld(), moments), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(AllAround, EveryView,
                         testing::Values(std::pair{0.0, 0.0}, std::pair{0.0, 10.0},
                                         std::pair{180.0, 0.0}, std::pair{179.0, -20.0},
                                         std::pair{-90.0, 49.0}, std::pair{30.0, 51.0},
                                         std::pair{77.0, 90.0}, std::pair{-120.0, -85.0}));

TEST(BackgroundWarp, ShowsAPointWhereOpenCvProjectsIt) {
  const Eigen::Matrix3d R = R_WC(20, 4);
  const PinholeRadtan camera = Camera();
  const cv::Mat K = (cv::Mat_<double>(3, 3) << camera.fx_px, 0, camera.cx_px, 0, camera.fy_px,
                     camera.cy_px, 0, 0, 1);
  const cv::Mat coefficients =
      (cv::Mat_<double>(4, 1) << camera.k1, camera.k2, camera.p1, camera.p2);
  for (const Eigen::Vector3d& p_C :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.15, 0.08, 1), Eigen::Vector3d(-0.17, 0.05, 1),
        Eigen::Vector3d(-0.1, -0.09, 1)}) {
    std::vector<cv::Point2d> q_px;
    cv::projectPoints(std::vector<cv::Point3d>{{p_C.x(), p_C.y(), p_C.z()}}, cv::Vec3d(0, 0, 0),
                      cv::Vec3d(0, 0, 0), K, coefficients, q_px);
    const Frame frame = Draw(PointWorld(R * p_C.normalized()), R);
    double sum = 0, x_sum = 0, y_sum = 0;
    for (int y = 0; y < kHeight_px; ++y) {
      for (int x = 0; x < kWidth_px; ++x) {
        sum += frame.At(x, y, 0);
        x_sum += x * frame.At(x, y, 0);
        y_sum += y * frame.At(x, y, 0);
      }
    }
    // Bound by the resampling of a 1.5 px spot on texels of 1.2 px and 1/256 texel weights.
    EXPECT_NEAR(x_sum / sum, q_px[0].x, 0.02);
    EXPECT_NEAR(y_sum / sum, q_px[0].y, 0.02);
  }
}

TEST(BackgroundWarp, IsTheSameFromAnyWindow) {
  const SmoothWorld world;
  EXPECT_EQ(Draw(world, R_WC(10, 5)).values, Draw(world, R_WC(10, 5), 700).values);
}

// Whatever was looked at before, by however many threads, with whatever beside it: a texel is a
// function of its place.
TEST(RadianceMap, GivesEachPlaceOneTexel) {
  const SmoothWorld world;
  RadianceMap one(world, kFocal_px), other(world, kFocal_px);
  MapWindow small, large;
  one.Cover(Chart::kUpright, 5030, 5100, 2600, 2690, 1, &small);
  other.Cover(Chart::kUpright, -200, 100, 2500, 2600, 3, &large);
  other.Cover(Chart::kLying, 4990, 5170, 2500, 2700, 3, &large);
  other.Cover(Chart::kUpright, 4990 - other.Width(), 5170 - other.Width(), 2500, 2700, 3, &large);
  for (int v = 2600; v <= 2690; ++v) {
    for (int u = 5030; u <= 5100; ++u) {
      const Texel texel = small.At(u - small.u0, v - small.v0);
      ASSERT_EQ(texel, large.At(u - other.Width() - large.u0, v - large.v0)) << u << ' ' << v;
      const Eigen::Vector3f d_W = one.DirectionAt(u, v, Chart::kUpright).cast<float>();
      ASSERT_NEAR(texel[0], world.Radiance(d_W, 0).x() * 32767, 1);  // Rounded.
    }
  }
}

TEST(RadianceMap, KeepsItsMemoryAndItsTexels) {
  const SmoothWorld world;
  RadianceMap map(world, kFocal_px);
  MapWindow first, window, again;
  map.Cover(Chart::kUpright, 0, 200, 2000, 2200, 2, &first);
  for (int u = -4000; u < 4000; u += 100) {  // 3,250 tiles of 64 × 64.
    map.Cover(Chart::kUpright, u, u + 600, 1000, 2600, 2, &window);
    ASSERT_LE(map.TileCount(), RadianceMap::kMaxTiles);
  }
  map.Cover(Chart::kUpright, 0, 200, 2000, 2200, 2, &again);
  EXPECT_EQ(again.planes, first.planes);
}

TEST(QuickAtan2, IsTheArcTangent) {
  for (int i = 0; i < 7200; ++i) {
    const double angle = (i - 3600) * EIGEN_PI / 3600 + 1e-9, r = 1e-3 + i;
    const double y = r * std::sin(angle), x = r * std::cos(angle);
    EXPECT_NEAR(QuickAtan2(y, x), std::atan2(y, x), 1e-13) << angle;
  }
  EXPECT_EQ(QuickAtan2(0, 1), 0);
  EXPECT_DOUBLE_EQ(QuickAtan2(1, 0), EIGEN_PI / 2);
  EXPECT_DOUBLE_EQ(QuickAtan2(0, -1), EIGEN_PI);
}

}  // namespace
}  // namespace windhover
