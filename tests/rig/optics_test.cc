#include "rig/optics.h"

#include <limits>

#include <gtest/gtest.h>

namespace windhover {
namespace {

constexpr double kFocal_m = 0.012, kPixel_m = 3.7325e-6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr PinholeRadtan kCamera{
    .fx_px = 3215, .fy_px = 3200, .cx_px = 639.5, .cy_px = 359.5, .k1 = -0.1};
constexpr StereoRig kRig{
    .left = kCamera, .right = kCamera, .baseline_m = 0.406, .width_px = 1280, .height_px = 720};

// 12 mm at 3 m: 12 / 2988 = 0.4016 %; at 5, 15 and 40 m 0.24, 0.08 and 0.03 %.
TEST(FocusMagnification, WorkedExamples) {
  EXPECT_NEAR(FocusMagnification(kFocal_m, 3), 1.004016, 1e-6);
  EXPECT_NEAR(FocusMagnification(kFocal_m, 5), 1.0024, 1e-5);
  EXPECT_NEAR(FocusMagnification(kFocal_m, 15), 1.0008, 1e-5);
  EXPECT_NEAR(FocusMagnification(kFocal_m, 40), 1.0003, 1e-5);
  EXPECT_EQ(FocusMagnification(kFocal_m, 0), 1);
}

// The image distance v = f · magnification fulfils the lens equation.
TEST(FocusMagnification, FulfilsTheLensEquation) {
  for (const double u_m : {0.1, 1.0, 15.0, 1e4}) {
    EXPECT_NEAR(1 / u_m + 1 / (kFocal_m * FocusMagnification(kFocal_m, u_m)), 1 / kFocal_m, 1e-9);
  }
}

TEST(WithOptics, LeavesTheCalibratedRigByDefault) {
  const StereoRig rig = WithOptics(kRig, OpticsConfig{}, kFocal_m);
  for (const auto& [a, b] : {std::pair{rig.left, kRig.left}, std::pair{rig.right, kRig.right}}) {
    EXPECT_EQ(a.intrinsics().fx_px, b.intrinsics().fx_px);
    EXPECT_EQ(a.intrinsics().fy_px, b.intrinsics().fy_px);
    EXPECT_EQ(a.intrinsics().cx_px, b.intrinsics().cx_px);
    EXPECT_EQ(a.intrinsics().cy_px, b.intrinsics().cy_px);
  }
}

// 20 K at 2e-5 per K: 3215 · 4e-4 = 1.286 px. A drift of 0.05 px per K: 1 px.
TEST(WithOptics, MovesEachCameraByItsOwnTemperature) {
  OpticsConfig optics;
  optics.temperature_change_K = 20;
  optics.thermal_focus_per_K = 2e-5;
  optics.right.thermal_focus_per_K = 0;
  optics.right.focus_m = 3;
  optics.left.cx_px_per_K = 0.05;
  optics.right.cy_px_per_K = -0.1;
  const StereoRig rig = WithOptics(kRig, optics, kFocal_m);
  const Intrinsics left = rig.left.intrinsics(), right = rig.right.intrinsics();
  EXPECT_NEAR(left.fx_px, 3215 + 1.286, 1e-9);
  EXPECT_NEAR(left.fy_px, 3200 + 1.28, 1e-9);
  EXPECT_NEAR(left.cx_px, 640.5, 1e-9);
  EXPECT_EQ(left.cy_px, 359.5);
  EXPECT_NEAR(right.fx_px, 3215 * 1.004016, 1e-3);
  EXPECT_EQ(right.cx_px, 639.5);
  EXPECT_NEAR(right.cy_px, 357.5, 1e-9);
  EXPECT_EQ(rig.left.As<PinholeRadtan>().k1, -0.1);
  EXPECT_EQ(rig.baseline_m, 0.406);
}

// V3.11: at f / 2.8 the dark ring is 0.5 px away; a lens focused at 15 m makes discs of 3.7 px at
// 3 m and 0.57 px at 40 m.
TEST(PointSpread, WorkedExamples) {
  EXPECT_NEAR(AiryRadius_m(2.8) / kPixel_m, 0.5, 0.01);
  EXPECT_NEAR(DiffractionSigma_m(2.8) / kPixel_m, 0.173, 0.001);
  EXPECT_NEAR(DefocusDiameter_m(kFocal_m, 2.8, 15, 3) / kPixel_m, 3.68, 0.01);
  EXPECT_NEAR(DefocusDiameter_m(kFocal_m, 2.8, 15, 40) / kPixel_m, 0.575, 0.001);
}

TEST(DefocusDiameter, IsContinuousAtItsLimits) {
  const auto at = [](double focus_m, double distance_m) {
    return DefocusDiameter_m(kFocal_m, 2.8, focus_m, distance_m);
  };
  EXPECT_EQ(at(15, 15), 0);
  EXPECT_EQ(at(0, kInfinity), 0);
  EXPECT_NEAR(at(0, 3), at(1e9, 3), 1e-12);
  EXPECT_NEAR(at(15, kInfinity), at(15, 1e9), 1e-12);
  EXPECT_NEAR(at(15, kInfinity), 0.012 / 2.8 * 0.012 / 14.988, 1e-12);
}

// cos⁴ at the edge (640 px) and at the corner (734 px) of the 12 mm rig.
TEST(Vignetting, WorkedExamples) {
  OpticsConfig optics;
  EXPECT_EQ(VignettingFactor(optics, 1), 1);
  optics.vignetting = true;
  EXPECT_NEAR(VignettingFactor(optics, 640.0 * 640 / (3215.0 * 3215)), 0.925, 5e-4);
  EXPECT_NEAR(VignettingFactor(optics, 734.3 * 734.3 / (3215.0 * 3215)), 0.903, 5e-4);
  optics.vignetting_r2 = 0.5;
  EXPECT_NEAR(VignettingFactor(optics, 1), 0.125, 1e-12);
  EXPECT_EQ(VignettingFactor(optics, 3), 0);
}

}  // namespace
}  // namespace windhover
