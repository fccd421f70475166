#include "scenarios/aircraft_config.h"

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace windhover {
namespace {

TEST(CalibratedRig, ToStereoRigWorkedExample) {
  CalibratedRig config;
  config.distortion = {.k1 = 1, .k2 = 2, .p1 = 3, .p2 = 4, .k3 = 5};
  const StereoRig rig = config.ToStereoRig();
  EXPECT_NEAR(rig.left.fx_px(), 3215, 0.01);      // 12 mm / 3.7325 um
  EXPECT_EQ(rig.left.intrinsics().cx_px, 639.5);  // the middle of pixels 0 ... 1279
  EXPECT_EQ(rig.right.intrinsics().cy_px, 359.5);
  EXPECT_EQ(rig.baseline_m, 0.406);
  EXPECT_EQ(rig.width_px, 1280);
  EXPECT_EQ(rig.height_px, 720);
  for (const AnyCamera& any : {rig.left, rig.right}) {
    const auto& camera = any.As<PinholeRadtan>();
    EXPECT_EQ(camera.k1, 1);
    EXPECT_EQ(camera.k2, 2);
    EXPECT_EQ(camera.p1, 3);
    EXPECT_EQ(camera.p2, 4);
    EXPECT_EQ(camera.k3, 5);
  }
}

TEST(CalibratedRig, LensModelsGetTheirTerms) {
  CalibratedRig config;
  config.distortion = {.k1 = 1,
                       .k2 = 2,
                       .p1 = 3,
                       .p2 = 4,
                       .k3 = 5,
                       .k4 = 6,
                       .k5 = 7,
                       .k6 = 8,
                       .s1 = 9,
                       .s2 = 10,
                       .s3 = 11,
                       .s4 = 12};
  config.distortion.model = LensModel::kKannalaBrandt;
  const auto fisheye = config.ToStereoRig().left.As<KannalaBrandt>().DistortionTerms();
  EXPECT_THAT((std::array{fisheye.k1, fisheye.k2, fisheye.k3, fisheye.k4}),
              testing::ElementsAre(1, 2, 5, 6));
  for (const bool has_prism : {false, true}) {
    config.distortion.model = has_prism ? LensModel::kThinPrism : LensModel::kRational;
    const auto m = config.ToStereoRig().right.As<PinholeRational>().DistortionTerms();
    EXPECT_THAT((std::array{m.k1, m.k2, m.p1, m.p2, m.k3, m.k4, m.k5, m.k6}),
                testing::ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    const double on = has_prism ? 1 : 0;
    EXPECT_THAT((std::array{m.s1, m.s2, m.s3, m.s4}),
                testing::ElementsAre(on * 9, on * 10, on * 11, on * 12));
  }
}

TEST(CalibratedRig, MountLooksForwardAndTiltsUp) {
  CalibratedRig config;
  config.mount.position_m = {0.15, 0.01, -0.02};
  EXPECT_TRUE(config.X_BR().linear().col(2).isApprox(Eigen::Vector3d::UnitX()));
  EXPECT_TRUE(config.X_BR().linear().col(0).isApprox(-Eigen::Vector3d::UnitY()));
  EXPECT_EQ(config.X_BR().translation(), Eigen::Vector3d(0.15, 0.01, -0.02));
  config.mount.pitch_deg = 30;
  const Eigen::Vector3d axis_B = config.X_BR().linear().col(2);
  EXPECT_NEAR(axis_B.x(), std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(axis_B.z(), 0.5, 1e-12);
}

}  // namespace
}  // namespace windhover
