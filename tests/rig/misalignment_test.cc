#include "rig/misalignment.h"

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr PinholeRadtan kCamera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};
constexpr StereoRig kRig{
    .left = kCamera, .right = kCamera, .baseline_m = 0.406, .width_px = 1280, .height_px = 720};

// Right minus left pixel of a point, as seen by a misaligned rig less as seen by the calibrated.
Eigen::Vector2d ChangeOfDisparity(const Misalignment& misalignment, const Vector3d& p_RQ_m) {
  const auto rest = Project(Posed(kRig), p_RQ_m).value();
  const auto seen = Project(Misaligned(kRig, misalignment), p_RQ_m).value();
  return (seen.left_px - seen.right_px) - (rest.left_px - rest.right_px);
}

Misalignment Relative(double yaw_deg, double pitch_deg, double roll_deg, double offset_px) {
  Misalignment misalignment;
  misalignment.yaw_deg = yaw_deg;
  misalignment.pitch_deg = pitch_deg;
  misalignment.roll_deg = roll_deg;
  misalignment.offset_px = offset_px;
  return misalignment;
}

TEST(Misaligned, NoneIsTheCalibratedRig) {
  const PosedStereoRig rig = Misaligned(kRig, {});
  EXPECT_TRUE(rig.left.X_RC.isApprox(Posed(kRig).left.X_RC, 0));
  EXPECT_TRUE(rig.right.X_RC.isApprox(Posed(kRig).right.X_RC, 0));
  EXPECT_EQ(rig.left.camera.intrinsics().cx_px, 639.5);
}

TEST(Misaligned, OffsetAddsToDisparityExactly) {
  const auto change_px = ChangeOfDisparity(Relative(0, 0, 0, 72), {1, 0.5, 20});
  EXPECT_NEAR(change_px.x(), 72, 1e-9);
  EXPECT_NEAR(change_px.y(), 0, 1e-9);
}

TEST(Misaligned, RelativeYawDiverges) {
  // 3215 px · 1 mrad = 3.215 px on the axis, half by each camera.
  const auto change_px = ChangeOfDisparity(Relative(DegFromRad(1e-3), 0, 0, 0), {0, 0, 40});
  EXPECT_NEAR(change_px.x(), 3.215, 1e-3);
  const PosedStereoRig rig = Misaligned(kRig, Relative(1, 0, 0, 0));
  EXPECT_GT(rig.right.X_RC.linear().col(2).x(), 0);
  EXPECT_LT(rig.left.X_RC.linear().col(2).x(), 0);
}

TEST(Misaligned, OneCameraAloneMovesOnlyItsOwnPixels) {
  Misalignment misalignment;
  misalignment.left = {.cx_px = 5, .cy_px = -3};
  misalignment.right = {.pitch_deg = DegFromRad(1e-3)};
  const auto rest = Project(Posed(kRig), {0, 0, 40}).value();
  const auto seen = Project(Misaligned(kRig, misalignment), {0, 0, 40}).value();
  EXPECT_NEAR((seen.left_px - rest.left_px - Eigen::Vector2d(5, -3)).norm(), 0, 1e-9);
  // A camera that looks up sees everything lower: +3.215 px.
  EXPECT_NEAR(seen.right_px.y() - rest.right_px.y(), 3.215, 1e-3);
}

TEST(Misaligned, ChangesSignWithItsCause) {
  for (const double x : {-0.1, 0.05}) {
    const Vector3d p_RQ_m = 20 * Vector3d(x, 0.06, 1);
    const Misalignment plus = Relative(0.01, 0.01, 0.01, 1);
    const Misalignment minus = Relative(-0.01, -0.01, -0.01, -1);
    // Odd to first order; the second order is f · (1.7e-4 rad)² = 1e-4 px.
    EXPECT_NEAR((ChangeOfDisparity(plus, p_RQ_m) + ChangeOfDisparity(minus, p_RQ_m)).norm(), 0,
                3e-4);
  }
}

}  // namespace
}  // namespace windhover
