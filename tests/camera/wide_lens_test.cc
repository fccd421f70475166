// The rational, thin-prism and Kannala-Brandt models where they are special; what holds for all
// models is in camera_model_test.cc.

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "camera/lens_config.h"
#include "camera/positive_root.h"
#include "tests/camera/camera_examples.h"

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Intrinsics kRound{1000, 1000, 640, 360};

TEST(PinholeRational, WorkedExample) {
  // x = 0.5, s = 0.25: q = (1 - 0.4 · 0.25) / (1 + 0.8 · 0.25) = 0.75, x' = 0.375 + 0.1 · 0.25.
  const PinholeRational camera(kRound, {.k1 = -0.4, .k4 = 0.8, .s1 = 0.1, .s3 = 0.2});
  const auto q_px = camera.Project({5, 0, 10});
  ASSERT_TRUE(q_px);
  EXPECT_DOUBLE_EQ(q_px->x(), 640 + 400);
  EXPECT_DOUBLE_EQ(q_px->y(), 360 + 50);
}

// V3.3
TEST(PinholeRational, WithoutDistortionIsAPinholeExactly) {
  const PinholeRational camera({512, 256, 100, 50}, {});
  EXPECT_EQ(camera.Project({1, 2, 4}).value(), Vector2d(100 + 512 / 4, 50 + 256 / 2));
}

// With the numerator alone the model is PinholeRadtan's, whose code is another.
TEST(PinholeRational, WithoutDenominatorIsRadtan) {
  for (const PinholeRadtan& m : test::ExampleCameras<PinholeRadtan>()) {
    const PinholeRational camera({m.fx_px, m.fy_px, m.cx_px, m.cy_px},
                                 {.k1 = m.k1, .k2 = m.k2, .p1 = m.p1, .p2 = m.p2, .k3 = m.k3});
    for (double x = -3; x <= 3; x += 0.13) {
      const Vector3d p_CQ_m(x, 0.3 * x, 2);
      const auto a = camera.Project(p_CQ_m), b = m.Project(p_CQ_m);
      ASSERT_EQ(a.has_value(), b.has_value()) << x;
      if (!a) continue;
      EXPECT_LT((*a - *b).norm(), 1e-9) << x;
    }
  }
}

// r / (1 + s) peaks at r = 1, where it is 1/2.
TEST(PinholeRational, HasNoAnswerBeyondTheFold) {
  const PinholeRational camera(kRound, {.k4 = 1});
  EXPECT_TRUE(camera.Project({1 - 1e-6, 0, 1}));
  EXPECT_FALSE(camera.Project({1 + 1e-6, 0, 1}));
  EXPECT_TRUE(camera.Unproject({640 + 500 - 1e-3, 360}));
  EXPECT_FALSE(camera.Unproject({640 + 500 + 1e-3, 360}));
}

// 1 - s vanishes at r = 1; r / (1 - s) grows without bound before.
TEST(PinholeRational, HasNoAnswerBeyondThePole) {
  const PinholeRational camera(kRound, {.k4 = -1});
  EXPECT_TRUE(camera.Project({0.999, 0, 1}));
  EXPECT_FALSE(camera.Project({1.001, 0, 1}));
  const auto ray_C = camera.Unproject({640 + 5e4, 360});  // r / (1 - r²) = 50.
  ASSERT_TRUE(ray_C);
  EXPECT_NEAR(ray_C->x() / ray_C->z(), (std::sqrt(1 + 4 * 50 * 50) - 1) / 100, 1e-12);
}

// V3.4
TEST(KannalaBrandt, WithoutTermsIsEquidistant) {
  const KannalaBrandt camera(kRound, {});
  for (const double angle_rad : {1e-9, 0.1, 0.7, 1.5}) {
    const auto q_px = camera.Project({0, 3 * std::sin(angle_rad), 3 * std::cos(angle_rad)});
    ASSERT_TRUE(q_px);
    EXPECT_DOUBLE_EQ(q_px->x(), 640);
    EXPECT_NEAR(q_px->y(), 360 + 1000 * angle_rad, 1e-10);
  }
}

TEST(KannalaBrandt, SeesTheAxis) {
  const KannalaBrandt camera(kRound, {.k1 = -0.1});
  PixelFromPointJacobian dq_dp;
  EXPECT_EQ(camera.Project({0, 0, 4}, &dq_dp).value(), Vector2d(640, 360));
  PixelFromPointJacobian expected;
  expected << 250, 0, 0, 0, 250, 0;
  EXPECT_EQ(dq_dp, expected);
  EXPECT_EQ(camera.Unproject({640, 360}).value(), Vector3d::UnitZ());
}

// θ - 0.4 θ³ peaks at θ = 0.913, where it is 0.609. Without terms, 90° end the image.
TEST(KannalaBrandt, HasNoAnswerBeyondTheFoldAndBehind) {
  const KannalaBrandt folded(kRound, {.k1 = -0.4}), plain(kRound, {});
  const double fold = 1 / std::sqrt(1.2);
  EXPECT_TRUE(folded.Project({std::tan(fold - 1e-6), 0, 1}));
  EXPECT_FALSE(folded.Project({std::tan(fold + 1e-6), 0, 1}));
  EXPECT_TRUE(folded.Unproject({640 + 1000 * (fold * 2 / 3 - 1e-6), 360}));
  EXPECT_FALSE(folded.Unproject({640 + 1000 * (fold * 2 / 3 + 1e-6), 360}));
  EXPECT_TRUE(plain.Unproject({640 + 1000 * (std::numbers::pi / 2 - 1e-6), 360}));
  EXPECT_FALSE(plain.Unproject({640 + 1000 * (std::numbers::pi / 2 + 1e-6), 360}));
}

TEST(AnyCamera, UnprojectIsRightOrEmpty) {
  std::vector<AnyCamera> cameras = test::ExampleCameras<AnyCamera>();
  cameras.push_back(PinholeRational(kRound, {.k1 = -0.6, .k2 = 0.15, .k4 = 0.3, .s1 = 0.02}));
  test::ExpectUnprojectIsRightOrEmpty(cameras);
}

TEST(AnyCamera, WithMovesTheImageAndKeepsTheLens) {
  for (const AnyCamera& camera : test::ExampleCameras<AnyCamera>()) {
    Intrinsics intrinsics = camera.intrinsics();
    const Vector3d p_CQ_m(0.1, 0.2, 1);
    const Vector2d before_px = camera.Project(p_CQ_m).value();
    intrinsics.cx_px += 3;
    intrinsics.cy_px -= 2;
    const Vector2d after_px = camera.With(intrinsics).Project(p_CQ_m).value();
    EXPECT_LT((after_px - before_px - Vector2d(3, -2)).norm(), 1e-9);
  }
}

TEST(FirstPositiveRoot, WorkedExamples) {
  EXPECT_NEAR(FirstPositiveRoot({6, -5, 1}), 2, 1e-15);  // (s - 2)(s - 3)
  EXPECT_NEAR(FirstPositiveRoot({-6, 11, -6, 1}), 1, 1e-14);
  EXPECT_NEAR(FirstPositiveRoot({1, 0, -1e-8, 0, 0}), 1e4, 1e-10);
  EXPECT_NEAR(FirstPositiveRoot({1, -1.8, 0.75}), 0.8734, 1e-4);
  EXPECT_EQ(FirstPositiveRoot({6, 5, 1}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(FirstPositiveRoot({1, 0, 0}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(FirstPositiveRoot({}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace windhover
