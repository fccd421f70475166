#include "rig/rig_motion.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rig/base_vibration.h"
#include "rig/imu_recording.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr PinholeRadtan kCamera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};
constexpr StereoRig kRig{
    .left = kCamera, .right = kCamera, .baseline_m = 0.406, .width_px = 1280, .height_px = 720};
const FlexConfig kFlex = [] {
  FlexConfig flex;
  flex.enabled = true;
  flex.frequency_hz = 117;
  flex.participation = 1.05;
  return flex;
}();
const std::string kRecordedFlight = WINDHOVER_REAL_INPUTS_DIR "/vibration/euroc_mh01_imu_200hz.csv";

VibrationConfig Psd() {
  VibrationConfig config;
  config.source = VibrationSource::kPsd;
  return config;
}

VibrationConfig Recorded(const std::string& file) {
  VibrationConfig config;
  config.source = VibrationSource::kRecorded;
  config.file = {file, file, ""};
  return config;
}

RigMotion Motion(const FlexConfig& flex, const VibrationConfig& vibration, std::uint64_t seed = 1,
                 const std::string& name = "uav0") {
  return {kRig, Misalignment{}, flex, vibration, seed, name};
}

// An IMU record of a pure tone: 2 s at 1000 Hz, without gravity.
std::string ToneFile(int column, double frequency_hz, double amplitude) {
  std::string text;
  for (int i = 0; i < 2000; ++i) {
    std::array<double, 6> values{};
    values[column] = amplitude * std::cos(2 * std::numbers::pi * frequency_hz * i / 1000);
    text += fmt::format("{:.3f},{}\n", i / 1000.0, fmt::join(values, ","));
  }
  return test::ScratchFile(text, fmt::format("tone{}", column));
}

double YawOf(const PosedCamera& camera) {
  const Vector3d axis = camera.X_RC.linear().col(2);
  return std::atan2(axis.x(), axis.z());
}

double RollOf(const PosedCamera& camera) {
  const Vector3d x_axis = camera.X_RC.linear().col(0);
  return std::atan2(x_axis.y(), x_axis.x());
}

double DisparityPx(const PosedStereoRig& rig, const Vector3d& p_RQ_m) {
  const auto seen = Project(rig, p_RQ_m).value();
  return seen.left_px.x() - seen.right_px.x();
}

TEST(RigMotion, WithoutVibrationIsTheMisalignedRig) {
  Misalignment misalignment;
  misalignment.yaw_deg = 0.3;
  misalignment.offset_px = 72;
  const RigMotion motion(kRig, misalignment, kFlex, {}, 1, "uav0");
  const PosedStereoRig expected = Misaligned(kRig, misalignment), rig = motion.At(12.3);
  EXPECT_TRUE(rig.left.X_RC.isApprox(expected.left.X_RC, 0));
  EXPECT_EQ(rig.right.camera.intrinsics().cx_px, expected.right.camera.intrinsics().cx_px);
}

// V2.4, V2.5: fore-aft acceleration of 1 m/s² at resonance: the tips swing by Γ a / (2 ζ ω₁²)
// = 64.8 um, so each camera by 0.479 mrad, in opposite yaw; the disparity by 3215 · 2 · 0.479 mrad
// = 3.08 px (physical models: 3.1 px for this bar).
TEST(RigMotion, ForeAftResonanceYawsTheCamerasAgainstEachOther) {
  const RigMotion motion = Motion(kFlex, Recorded(ToneFile(3, 117, 1)));
  double largest_yaw_rad = 0, largest_px = 0;
  const double rest_px = DisparityPx(Posed(kRig), {0, 0, 20});
  for (int i = 0; i < 2000; ++i) {
    const PosedStereoRig rig = motion.At(i / 11700.0);
    EXPECT_NEAR(YawOf(rig.left), -YawOf(rig.right), 1e-15);
    EXPECT_NEAR(RollOf(rig.left), 0, 1e-12);
    EXPECT_NEAR(rig.left.X_RC.linear()(1, 2), 0, 1e-12);  // no pitch
    EXPECT_NEAR((rig.right.X_RC.translation() - rig.left.X_RC.translation()).norm(), 0.406, 1e-9);
    EXPECT_NEAR(rig.left.X_RC.translation().z(), rig.right.X_RC.translation().z(), 1e-15);
    largest_yaw_rad = std::max(largest_yaw_rad, std::abs(YawOf(rig.left)));
    largest_px = std::max(largest_px, std::abs(DisparityPx(rig, {0, 0, 20}) - rest_px));
  }
  EXPECT_NEAR(largest_yaw_rad, 0.479e-3, 0.001e-3);
  EXPECT_NEAR(largest_px, 3.08, 0.02);
}

// Quasi-static sign: a root that accelerates forward leaves the tips behind; cameras then look
// apart (tips behind: the ends of the bar point backward), and disparity grows.
TEST(RigMotion, SlowForwardAccelerationDiverges) {
  const RigMotion motion = Motion(kFlex, Recorded(ToneFile(3, 12, 1)));
  const PosedStereoRig rig = motion.At(0);
  EXPECT_LT(rig.left.X_RC.translation().z(), 0);
  EXPECT_GT(YawOf(rig.right), 0);
  EXPECT_GT(DisparityPx(rig, {0, 0, 20}), DisparityPx(Posed(kRig), {0, 0, 20}));
}

TEST(RigMotion, VerticalAccelerationRollsTheCamerasAgainstEachOther) {
  const RigMotion motion = Motion(kFlex, Recorded(ToneFile(5, 12, 1)));
  const PosedStereoRig rig = motion.At(0);  // Accelerates up: the tips hang down.
  EXPECT_GT(rig.right.X_RC.translation().y(), 0);
  EXPECT_GT(RollOf(rig.right), 0);
  EXPECT_NEAR(RollOf(rig.left), -RollOf(rig.right), 1e-15);
  EXPECT_NEAR(YawOf(rig.right), 0, 1e-12);
}

TEST(RigMotion, LateralAccelerationDoesNotBend) {
  EXPECT_TRUE(Motion(kFlex, Recorded(ToneFile(4, 117, 1)))
                  .At(0.1)
                  .left.X_RC.isApprox(Posed(kRig).left.X_RC, 1e-12));
}

// V1.5: common rotation: a rate of 0.1 rad/s at 20 Hz about the body's z (up) turns the rig by
// 0.1 / (2π 20) = 0.796 mrad, to the left when positive, and leaves every range as it is.
TEST(RigMotion, CommonRotationDoesNotChangeRange) {
  const RigMotion motion = Motion(FlexConfig{}, Recorded(ToneFile(2, 20, 0.1)));
  double largest_yaw_rad = 0;
  for (int i = 0; i < 200; ++i) {
    const PosedStereoRig rig = motion.At(i / 4000.0);
    largest_yaw_rad = std::max(largest_yaw_rad, std::abs(YawOf(rig.left)));
    const Vector3d p_RQ_m(1.5, -0.7, 20);
    const auto seen = Project(rig, p_RQ_m).value();
    const auto point = Triangulate(kRig, seen.left_px, seen.right_px, 0).value();
    EXPECT_NEAR(point.range_m, p_RQ_m.norm(), 1e-9);
  }
  EXPECT_NEAR(largest_yaw_rad, 0.796e-3, 0.001e-3);
  // The integral of cos is sin: a quarter period in, the rig has turned left (negative about y).
  EXPECT_NEAR(YawOf(motion.At(1 / 80.0).left), -0.796e-3, 1e-6);
}

TEST(RigMotion, LevelScalesEverything) {
  VibrationConfig twice = Psd();
  twice.level = 2;
  const RigMotion one = Motion(kFlex, Psd()), two = Motion(kFlex, twice);
  for (double t_s = 0; t_s < 3; t_s += 0.31) {
    EXPECT_NEAR(two.DeflectionAt(t_s).right.forward_m, 2 * one.DeflectionAt(t_s).right.forward_m,
                1e-15);
    EXPECT_TRUE(two.DeflectionAt(t_s).turn_rad.isApprox(2 * one.DeflectionAt(t_s).turn_rad, 1e-9));
  }
}

// V1.3
TEST(RigMotion, SameSeedSameBitsInAnyOrderOnAnyThread) {
  const RigMotion one = Motion(kFlex, Psd()), two = Motion(kFlex, Psd());
  std::vector<Eigen::Matrix4d> forward(50), backward(50);
  std::thread other([&] {
    for (int i = 0; i < 50; ++i) forward[i] = one.At(i * 0.037).right.X_RC.matrix();
  });
  for (int i = 49; i >= 0; --i) backward[i] = two.At(i * 0.037).right.X_RC.matrix();
  other.join();
  for (int i = 0; i < 50; ++i) EXPECT_EQ(forward[i], backward[i]);
  EXPECT_NE(Motion(kFlex, Psd(), 2).At(1).right.X_RC.matrix(), two.At(1).right.X_RC.matrix());
  EXPECT_NE(Motion(kFlex, Psd(), 1, "uav1").At(1).right.X_RC.matrix(),
            two.At(1).right.X_RC.matrix());
}

// The default floor on the default bar: 0.92 px rms of disparity (physical models, table 1.5).
// The forward share of the floor is 0.3; lines within the resonance make it a few per cent
// random, over seeds too.
TEST(RigMotion, DefaultFloorShakesDisparityByAPixel) {
  VibrationConfig vibration = Psd();
  vibration.angular_rate_rms_radps = 0;
  double sum = 0;
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const RigMotion motion = Motion(kFlex, vibration, seed);
    for (int i = 0; i < 2000; ++i, ++n) {
      const double change_px =
          DisparityPx(motion.At(i * 0.0101), {0, 0, 20}) - DisparityPx(Posed(kRig), {0, 0, 20});
      sum += change_px * change_px;
    }
  }
  EXPECT_NEAR(std::sqrt(sum / n), 0.92, 0.15);
}

TEST(RigMotion, TurnsByTheIntegralOfTheRecordedRate) {
  if (!std::filesystem::exists(kRecordedFlight)) GTEST_SKIP() << "no " << kRecordedFlight;
  const VibrationConfig vibration = Recorded(kRecordedFlight);
  const BaseVibration base = MakeBaseVibration(vibration, 1, "uav0");
  const Sinusoids yaw = Filtered(base.angular_rate_radps[2], Integration);
  const RigMotion motion = Motion(kFlex, vibration);
  for (const double t_s : {0.0, 0.0123, 7.7, 59.9, 100.0}) {
    EXPECT_NEAR(motion.DeflectionAt(t_s).turn_rad.y(), -Value(yaw, t_s), 1e-13) << t_s;
  }
}

}  // namespace
}  // namespace windhover
