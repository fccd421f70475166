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

#include "rig/bar_modes.h"
#include "rig/base_vibration.h"
#include "rig/imu_recording.h"
#include "rig/isolator.h"
#include "rig/power_spectrum.h"
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

// A row of the table of differential jitter (physical models, 1.5), px of disparity; and the unit
// of each number's last digit.
struct Printed {
  double px, unit;
};
struct JitterRow {
  BarSectionType section;
  double camera_mass_kg, damping;
  Printed floor, tones_median, tones_max, mounted_floor, mounted_tones_max;

  FlexConfig Flex() const {
    FlexConfig flex;
    flex.enabled = true;
    flex.section = section;
    flex.camera_mass_kg = camera_mass_kg;
    flex.damping = damping;
    return flex;
  }
};

// The damping is that of the table of sections (2.2), and the default bar's own.
const std::array<JitterRow, 5> kJitterRows = {{
    {BarSectionType::kCfTube16x14,
     0.15,
     0.01,
     {2.2, .1},
     {.23, .01},
     {.67, .01},
     {.18, .01},
     {.03, .01}},
    {BarSectionType::kCfTube20x18,
     0.12,
     0.015,
     {.92, .01},
     {.31, .01},
     {2.5, .1},
     {.06, .01},
     {.08, .01}},
    {BarSectionType::kCfPlate40x3Strong,
     0.12,
     0.01,
     {.27, .01},
     {.02, .01},
     {.04, .01},
     {.01, .01},
     {.001, .001}},
    {BarSectionType::kAl2020,
     0.12,
     0.005,
     {.92, .01},
     {.07, .01},
     {1.3, .1},
     {.03, .01},
     {.03, .01}},
    {BarSectionType::kAlPlate40x4Weak,
     0.12,
     0.005,
     {12.5, .1},
     {.2, .1},
     {.4, .1},
     {3.0, .1},
     {.05, .01}},
}};

// Half a unit of the last digit, and 1 %: the weak plate's floor is 12.55, its mounted tone 0.0446
// with the mode at 30.8 Hz, which the table rounds to 31 Hz; in that, floors go as f^-1.5.
void ExpectAsPrinted(double px, const Printed& printed) {
  EXPECT_NEAR(px, printed.px, printed.unit / 2 + 0.01 * printed.px);
}

IsolatorConfig Mounts(bool enabled) { return {.enabled = enabled}; }

// The disparity's rms in closed form: sum over narrow bins of power times the squared response of
// both tips. 8000 bins: 30 within the narrowest resonance.
double FloorPx(const JitterRow& row, const IsolatorConfig& isolator) {
  const PowerSpectrum spectrum = PowerSpectrum::SmallMultirotorFloor();
  const BarModes modes = ModesOf(row.Flex(), kRig.baseline_m);
  const double px_per_m = 2 * TipSlope_rad(1, kRig.baseline_m / 2) * kCamera.fx_px;
  const double ratio = VibrationConfig{}.axis_ratio[0] * kStandardGravity_mps2;
  double sum = 0;
  const int n = 8000;
  for (int i = 0; i < n; ++i) {
    const double from_hz = 10 * std::pow(50, 1.0 * i / n), to_hz = 10 * std::pow(50, (i + 1.0) / n);
    const double middle_hz = std::sqrt(from_hz * to_hz);
    const double gain =
        std::abs(px_per_m * ratio * modes.participation * Response(modes.forward, middle_hz) *
                 Transmissibility(isolator, middle_hz));
    sum += gain * gain * spectrum.Power_g2(from_hz, to_hz);
  }
  return std::sqrt(sum);
}

TEST(DifferentialJitter, FloorOfEveryBarIsThatOfTheTable) {
  for (const JitterRow& row : kJitterRows) {
    SCOPED_TRACE(static_cast<int>(row.section));
    ExpectAsPrinted(FloorPx(row, Mounts(false)), row.floor);
    ExpectAsPrinted(FloorPx(row, Mounts(true)), row.mounted_floor);
  }
}

// The whole chain against that: 512 lines for the spectrum are so few in a narrow resonance that
// the power of one seed scatters by half; 40 seeds leave 8 % of power, 4 % of the rms. Three of
// these.
TEST(DifferentialJitter, ShakesTheDisparityOfATarget) {
  VibrationConfig vibration = Psd();
  vibration.angular_rate_rms_radps = 0;
  for (const JitterRow& row : kJitterRows) {
    for (const bool mounted : {false, true}) {
      vibration.isolator = Mounts(mounted);
      double sum = 0;
      int n = 0;
      for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const RigMotion motion = Motion(row.Flex(), vibration, seed);
        for (int i = 0; i < 50; ++i, ++n) {
          const double change_px =
              DisparityPx(motion.At(i * 0.4101), {0, 0, 20}) - DisparityPx(Posed(kRig), {0, 0, 20});
          sum += change_px * change_px;
        }
      }
      EXPECT_NEAR(std::sqrt(sum / n) / FloorPx(row, vibration.isolator), 1, 0.12)
          << static_cast<int>(row.section) << (mounted ? " mounted" : "");
    }
  }
}

// What the tones of four rotors with phases of their own make of the disparity, rms, that turn
// `rate_hz` times a second. As in the table, amplitudes do not go with the speed.
double TonesPx(const JitterRow& row, const IsolatorConfig& isolator, double rate_hz) {
  VibrationConfig vibration;
  vibration.source = VibrationSource::kRotors;
  vibration.isolator = isolator;
  vibration.angular_rate_rms_radps = 0;
  vibration.rotors.reference_hz = rate_hz;
  const DrivenBar driven(row.Flex(), vibration, kRig.baseline_m, 1, "uav0");
  RigDrive drive;
  drive.rotor_rate_hz = {rate_hz, 0, 0, 0};
  const DrivenBar::Tick tick(driven, drive);
  double sum = 0;
  const int n = 16;  // Of one turn: tones of 1, 2 and 4 are orthogonal.
  for (int i = 0; i < n; ++i) {
    const BarState bar = tick.At(i / (n * rate_hz)).bar;
    const double yaw_rad = TipSlope_rad(bar[0].x + bar[3].x, kRig.baseline_m / 2);
    sum += std::pow(kCamera.fx_px * yaw_rad, 2) / n;
  }
  return std::sqrt(4 * sum);
}

TEST(DifferentialJitter, TonesOfEveryBarAreThoseOfTheTable) {
  for (const JitterRow& row : kJitterRows) {
    SCOPED_TRACE(static_cast<int>(row.section));
    std::vector<double> hard_px, mounted_px;
    for (int i = 0; i <= 720; ++i) {  // 42 to 60 turns a second.
      hard_px.push_back(TonesPx(row, Mounts(false), 42 + i / 40.0));
      mounted_px.push_back(TonesPx(row, Mounts(true), 42 + i / 40.0));
    }
    std::sort(hard_px.begin(), hard_px.end());
    ExpectAsPrinted(hard_px[360], row.tones_median);
    ExpectAsPrinted(hard_px.back(), row.tones_max);
    ExpectAsPrinted(*std::max_element(mounted_px.begin(), mounted_px.end()), row.mounted_tones_max);
  }
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
