#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "camera/any_camera.h"

namespace windhover::test {

/// Cameras that every camera-model test runs on.
template <typename Model>
std::vector<Model> ExampleCameras();

inline constexpr Intrinsics kEuroc{458.654, 457.296, 367.215, 248.375};
inline constexpr Intrinsics kTele{3215, 3214, 639.5, 359.5};
inline constexpr Intrinsics kWide{900, 900, 639.5, 359.5};

/// The EuRoC MAV data set's cam0, the same lens without distortion, a 12 mm lens with all five
/// terms at 3215 px, and a strong barrel.
template <>
inline std::vector<PinholeRadtan> ExampleCameras() {
  return {{.fx_px = 458.654, .fy_px = 457.296, .cx_px = 367.215, .cy_px = 248.375},
          {.fx_px = 458.654,
           .fy_px = 457.296,
           .cx_px = 367.215,
           .cy_px = 248.375,
           .k1 = -0.28340811,
           .k2 = 0.07395907,
           .p1 = 0.00019359,
           .p2 = 1.76187114e-05},
          {.fx_px = 3215,
           .fy_px = 3214,
           .cx_px = 639.5,
           .cy_px = 359.5,
           .k1 = -0.1,
           .k2 = 0.3,
           .p1 = 1e-3,
           .p2 = -5e-4,
           .k3 = 0.05},
          {.fx_px = 900, .fy_px = 900, .cx_px = 639.5, .cy_px = 359.5, .k1 = -0.4, .k2 = 0.15}};
}

/// No distortion; five terms; eight, of which large ones nearly cancel, as fits often do; twelve.
template <>
inline std::vector<PinholeRational> ExampleCameras() {
  return {
      {kEuroc, {}},
      {kEuroc, {.k1 = -0.28, .k2 = 0.07, .p1 = 2e-4, .p2 = 2e-5}},
      {kWide,
       {.k1 = 5.3, .k2 = 2.1, .p1 = 4e-4, .p2 = -2e-4, .k3 = 0.3, .k4 = 5.6, .k5 = 3.3, .k6 = 0.6}},
      {kTele,
       {.k1 = -0.1,
        .k2 = 0.3,
        .p1 = 1e-3,
        .p2 = -5e-4,
        .k3 = 0.05,
        .k4 = 0.02,
        .k5 = -0.1,
        .k6 = 0.03,
        .s1 = 2e-3,
        .s2 = -1e-3,
        .s3 = -3e-3,
        .s4 = 2e-3}}};
}

/// No distortion; a wide-angle lens; a tele lens.
template <>
inline std::vector<KannalaBrandt> ExampleCameras() {
  return {{kEuroc, {}},
          {kEuroc, {.k1 = -0.0137, .k2 = 0.0207, .k3 = -0.0128, .k4 = 0.00253}},
          {kTele, {.k1 = -0.08, .k2 = 0.01}}};
}

/// One of each model.
template <>
inline std::vector<AnyCamera> ExampleCameras() {
  return {ExampleCameras<PinholeRadtan>()[2], ExampleCameras<PinholeRational>()[2],
          ExampleCameras<PinholeRational>()[3], ExampleCameras<KannalaBrandt>()[1]};
}

/// A pixel far outside must end in nothing, never in a wrong direction.
template <typename Camera>
void ExpectUnprojectIsRightOrEmpty(const std::vector<Camera>& cameras) {
  int empty = 0, seen = 0;
  for (const Camera& camera : cameras) {
    for (double u_px = -5000; u_px <= 6000; u_px += 137) {
      for (double v_px = -5000; v_px <= 6000; v_px += 211) {
        const auto ray_C = camera.Unproject({u_px, v_px});
        if (!ray_C) {
          ++empty;
          continue;
        }
        ++seen;
        const auto q_px = camera.Project(*ray_C);
        ASSERT_TRUE(q_px) << u_px << ", " << v_px;
        EXPECT_LT((*q_px - Eigen::Vector2d(u_px, v_px)).norm(), 1e-8);
      }
    }
  }
  EXPECT_GT(empty, 100);
  EXPECT_GT(seen, 100);
}

}  // namespace windhover::test
