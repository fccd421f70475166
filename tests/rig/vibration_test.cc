// Vibration as a whole: what rotors, spectra, recordings and isolators do to the cameras.

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include "common/config/fields.h"
#include "rig/base_vibration.h"
#include "rig/half_bar.h"
#include "rig/isolator.h"
#include "rig/power_spectrum.h"
#include "rig/rig_motion.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr PinholeRadtan kCamera{.fx_px = 3215, .fy_px = 3215, .cx_px = 639.5, .cy_px = 359.5};
constexpr StereoRig kRig{
    .left = kCamera, .right = kCamera, .baseline_m = 0.406, .width_px = 1280, .height_px = 720};

VibrationConfig From(VibrationSource source) {
  VibrationConfig vibration;
  vibration.source = source;
  return vibration;
}

// Only the tones of rotors: no floor, no turning.
VibrationConfig TonesOnly() {
  VibrationConfig vibration = From(VibrationSource::kRotors);
  const std::string silence = test::ScratchFile("10,1e-30\n500,1e-30\n", "silence");
  vibration.file = {silence, silence, ""};
  vibration.angular_rate_rms_radps = 0;
  return vibration;
}

FlexConfig Flexible(double damping = 0.015) {
  FlexConfig flex;
  flex.enabled = true;
  flex.damping = damping;
  return flex;
}

RigMotion Motion(const FlexConfig& flex, const VibrationConfig& vibration, double mean_over_s = 0) {
  return {kRig, Misalignment{}, flex, vibration, 1, "uav0", mean_over_s};
}

RigDrive AllRotorsAt(double rate_hz) {
  RigDrive drive;
  drive.rotor_rate_hz.fill(rate_hz);
  return drive;
}

double YawOf(const PosedCamera& camera) {
  const Vector3d axis = camera.X_RC.linear().col(2);
  return std::atan2(axis.x(), axis.z());
}

// Amplitude of samples at a frequency that fits into them a whole number of times.
double AmplitudeAt(const std::vector<double>& samples, double rate_hz, double frequency_hz) {
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double t_s = static_cast<double>(i) / rate_hz;
    sum += samples[i] * std::polar(1.0, -kTwoPi * frequency_hz * t_s);
  }
  return 2 * std::abs(sum) / static_cast<double>(samples.size());
}

std::vector<double> UpDeflections(const RigMotion& motion, const RigDrive& drive, double rate_hz,
                                  int n) {
  std::vector<double> samples;
  for (int i = 0; i < n; ++i) samples.push_back(motion.DeflectionAt(i / rate_hz, drive).right.up_m);
  return samples;
}

// V1.4
TEST(Isolator, IsOneAtRootTwoWhateverTheDamping) {
  for (const double damping : {0.05, 0.15, 0.3, 1.0}) {
    const IsolatorConfig isolator{.enabled = true, .frequency_hz = 12, .damping = damping};
    EXPECT_NEAR(std::abs(Transmissibility(isolator, 12 * std::numbers::sqrt2)), 1, 1e-12);
    EXPECT_EQ(Transmissibility(isolator, 0), std::complex<double>(1));
    // Far above: 2 ζ / r, to 1 / (2 ζ r)².
    const double r = 1e4;
    EXPECT_NEAR(std::abs(Transmissibility(isolator, 12 * r)) * r / (2 * damping), 1, 1e-5);
    // The peak is where the textbooks put it.
    const double peak = std::sqrt(std::sqrt(1 + 8 * damping * damping) - 1) / (2 * damping);
    const double largest = std::abs(Transmissibility(isolator, 12 * peak));
    EXPECT_GT(largest, std::abs(Transmissibility(isolator, 12 * peak * 1.01)));
    EXPECT_GT(largest, std::abs(Transmissibility(isolator, 12 * peak * 0.99)));
  }
  EXPECT_EQ(Transmissibility(IsolatorConfig{}, 50), std::complex<double>(1));
}

// V1.4, Miles: σ² = π f S / (4 ζ ω⁴) of a mode under white acceleration S per Hz; 4096 lines, 70
// of them within the resonance's width, band-limited to 20 times its frequency.
TEST(Mode, RandomResponseIsMilesFormula) {
  const Mode mode{kTwoPi * 100, 0.02};
  const PowerSpectrum white({{1, 0.01}, {2000, 0.01}});
  double sum = 0;
  const int n_seeds = 4;
  for (int seed = 0; seed < n_seeds; ++seed) {
    const Sinusoids x = Filtered(white.Synthesize(0, 4096, RandomStream(seed, "white")),
                                 [&](double f) { return Response(mode, f); });
    sum += std::pow(Rms(x), 2) / n_seeds;
  }
  const double S = 0.01 * kStandardGravity_mps2 * kStandardGravity_mps2;
  const double miles = std::numbers::pi * 100 * S / (4 * 0.02 * std::pow(kTwoPi * 100, 4));
  EXPECT_NEAR(sum / miles, 1, 0.01);
}

// 12 Hz mounts: at a blade pass of 100 Hz the root keeps 2 ζ / r + 1 / r² of the shaking.
TEST(Isolator, StandsBetweenEverySourceAndTheBar) {
  VibrationConfig hard = TonesOnly(), soft = TonesOnly();
  hard.angular_rate_rms_radps = soft.angular_rate_rms_radps = 0.05;
  soft.isolator.enabled = true;
  const RigDrive drive = AllRotorsAt(50);
  const auto amplitude = [&](const VibrationConfig& vibration, double frequency_hz) {
    return AmplitudeAt(UpDeflections(Motion(Flexible(), vibration), drive, 2000, 2000), 2000,
                       frequency_hz);
  };
  for (const double frequency_hz : {50.0, 100.0, 200.0}) {
    EXPECT_NEAR(amplitude(soft, frequency_hz) / amplitude(hard, frequency_hz),
                std::abs(Transmissibility(soft.isolator, frequency_hz)), 1e-9);
  }
  VibrationConfig floor = From(VibrationSource::kPsd);
  const Sinusoids bare = MakeBaseVibration(floor, 1, "uav0").acceleration_mps2[2];
  floor.isolator.enabled = true;
  const Sinusoids mounted = MakeBaseVibration(floor, 1, "uav0").acceleration_mps2[2];
  EXPECT_NEAR(mounted[400].amplitude / bare[400].amplitude,
              std::abs(Transmissibility(floor.isolator, bare[400].frequency_hz)), 1e-12);
}

// V1.5: tones of the rotors turn the whole rig; a stiff one measures the same range.
TEST(RotorTones, CommonTurningDoesNotChangeRange) {
  const RigMotion motion = Motion(FlexConfig{}, From(VibrationSource::kRotors));
  double largest_rad = 0;
  for (int i = 0; i < 200; ++i) {
    const PosedStereoRig rig = motion.At(i / 4000.0, AllRotorsAt(50));
    largest_rad = std::max(largest_rad, std::abs(YawOf(rig.left)));
    const Vector3d p_RQ_m(1.5, -0.7, 20);
    const auto seen = Project(rig, p_RQ_m).value();
    const auto point = Triangulate(kRig, seen.left_px, seen.right_px, 0).value();
    EXPECT_NEAR(point.range_m, p_RQ_m.norm(), 1e-9);
  }
  // 0.05 rad/s rms at 50 and 100 Hz is 0.16 mrad rms or less; eight tones, in step, thrice that.
  EXPECT_GT(largest_rad, 0.05e-3);
  EXPECT_LT(largest_rad, 0.6e-3);
}

TEST(RotorTones, TurnAsFastAsTheyAreTold) {
  const RigMotion motion = Motion(FlexConfig{}, From(VibrationSource::kRotors));
  RigDrive drive;
  drive.rotor_rate_hz = {47, 49, 51, 53};  // All whole: one second is a period.
  Vector3d mean_square = Vector3d::Zero();
  const int n = 2000;
  const double h_s = 1.0 / n;
  for (int i = 0; i < n; ++i) {
    const Vector3d rate_radps = (motion.DeflectionAt(i * h_s + 1e-6, drive).turn_rad -
                                 motion.DeflectionAt(i * h_s - 1e-6, drive).turn_rad) /
                                2e-6;
    mean_square += rate_radps.cwiseAbs2() / n;
  }
  // The rms of the rate is the configured one where all turn at 50 Hz; speeds differ by 6 %.
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::sqrt(mean_square[axis]), 0.05, 0.002);
}

// V1.8: lines at 1, 2 and 4 times each rotor's speed and nowhere else; amplitude ∝ n².
TEST(RotorTones, AreMultiplesOfTheRotorsSpeeds) {
  FlexConfig stiff = Flexible();
  stiff.frequency_hz = 4000;  // Its deflection follows the acceleration.
  const RigMotion motion = Motion(stiff, TonesOnly());
  RigDrive drive;
  drive.rotor_rate_hz = {46, 49, 51, 53};
  std::vector<double> samples = UpDeflections(motion, drive, 2048, 2048);  // Bins of 1 Hz.
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> bins;
  fft.fwd(bins, samples);
  const double w1 = kTwoPi * 4000, gain = ModesOf(stiff, 0.406).participation / (w1 * w1);
  const std::array<double, 3> amplitudes_mps2 = {0.5, 2.0, 0.7};
  double explained = 0, all = 0;
  for (std::size_t k = 1; k < 1024; ++k) all += std::norm(bins[k]);
  for (const double rate_hz : drive.rotor_rate_hz) {
    for (int i = 0; i < 3; ++i) {
      const int bin = static_cast<int>(rate_hz) << i;
      explained += std::norm(bins[bin]);
      const double amplitude_m = 2 * std::abs(bins[bin]) / 2048;
      // (f / 4000 Hz)² of dynamics: 0.3 % at 212 Hz.
      EXPECT_NEAR(amplitude_m / (gain * amplitudes_mps2[i] * std::pow(rate_hz / 50, 2)), 1, 0.004);
    }
  }
  EXPECT_NEAR(explained / all, 1, 1e-9);
}

// The whole chain at resonance, from physics alone: a bar whose f₁ is the blade pass of a hovering
// P600 (two times 56.5 Hz), four rotors in step. The relative yaw of the cameras is
// 2 · 3/(2L) · Γ a / (2 ζ ω₁²), with a = Σ 0.3 A₂ (n/n₀)² of rotors whose phases are random.
TEST(RotorTones, BladePassOnTheBarsModeYawsByTheClosedForm) {
  FlexConfig flex = Flexible(0.01);
  const double rate_hz = 56.5;
  flex.section = BarSectionType::kCfTube20x18;
  // M such that f₁ = BPF: ω² = 3 EI / (L³ (M + 33/140 ρAL)), refined on the exact root.
  double low_kg = 0.01, high_kg = 1;
  for (int i = 0; i < 60; ++i) {
    flex.camera_mass_kg = (low_kg + high_kg) / 2;
    const double f1_hz = ModesOf(flex, 0.406).forward.frequency_radps / kTwoPi;
    (f1_hz > 2 * rate_hz ? low_kg : high_kg) = flex.camera_mass_kg;
  }
  EXPECT_NEAR(flex.camera_mass_kg, 0.13, 0.01);
  VibrationConfig one_order = TonesOnly();
  one_order.rotors.a_1p_mps2 = one_order.rotors.a_4p_mps2 = 0;
  const RigMotion motion = Motion(flex, one_order);
  RigDrive one_rotor;
  one_rotor.rotor_rate_hz = {rate_hz, 0, 0, 0};
  double largest_rad = 0;
  for (int i = 0; i < 4000; ++i) {
    const PosedStereoRig rig = motion.At(i * 1e-4, one_rotor);
    largest_rad = std::max(largest_rad, std::abs(YawOf(rig.right) - YawOf(rig.left)));
  }
  const BarModes modes = ModesOf(flex, 0.406);
  const double a_mps2 = 0.3 * 2.0 * std::pow(rate_hz / 50, 2);
  const double w1 = kTwoPi * 2 * rate_hz;
  const double closed_rad =
      modes.participation * a_mps2 / (2 * 0.01 * w1 * w1) * 3 / (2 * 0.203) * 2;
  EXPECT_NEAR(largest_rad / closed_rad, 1, 1e-3);
  EXPECT_GT(3215 * closed_rad, 3);  // More than 3 px of disparity by one rotor.
  // A tenth off the resonance a tenth of that is left.
  one_rotor.rotor_rate_hz[0] *= 1.1;
  for (int i = 0; i < 4000; ++i) {
    const PosedStereoRig rig = motion.At(i * 1e-4, one_rotor);
    EXPECT_LT(std::abs(YawOf(rig.right) - YawOf(rig.left)), 0.15 * closed_rad);
  }
}

// From rest the bar swings up to that: 1 - exp(-ζ ω t) of it.
TEST(DrivenBar, BuildsUpAtResonance) {
  FlexConfig flex = Flexible(0.01);
  flex.frequency_hz = 100;
  const DrivenBar bar(flex, TonesOnly(), 0.406, 1, "uav0");
  RigDrive drive = AllRotorsAt(50);
  const BarState steady = DrivenBar::Tick(bar, drive).At(0).bar;
  drive.bar = BarState{};
  const DrivenBar::Tick tick(bar, drive);
  for (const int periods : {0, 4, 16, 64}) {
    const double t_s = periods / 50.0;  // Every tone is where it was.
    const double left = std::exp(-0.01 * kTwoPi * 100 * t_s);
    // Tones off the resonance have died or beat: 5 % of it.
    EXPECT_NEAR(tick.At(t_s).bar[4].x, (1 - left) * steady[4].x, 0.05 * std::abs(steady[4].x));
  }
}

// The state that sim carries from tick to tick goes on where the closed form of the tick ends.
TEST(DrivenBar, StepsAlongTheClosedForm) {
  const DrivenBar bar(Flexible(), From(VibrationSource::kRotors), 0.406, 1, "uav0");
  RigDrive now;
  now.rotor_rate_hz = {47, 49, 51, 53.5};
  now.rotor_phase_rev = {0.1, 0.2, 0.3, 0.4};
  now.specific_force_B_mps2 = {0.4, -0.2, 11};
  now.bar = BarState{};
  for (int i = 0; i < 10; ++i) {
    RigDrive next = now;
    next.start_s += 0.1;
    for (int r = 0; r < 4; ++r) next.rotor_phase_rev[r] += 0.1 * now.rotor_rate_hz[r];
    next.bar = bar.Stepped(now, next);
    const BarState expected = DrivenBar::Tick(bar, now).At(next.start_s).bar;
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR((*next.bar)[k].x, expected[k].x, 1e-15);
      EXPECT_NEAR((*next.bar)[k].v, expected[k].v, 1e-12);
    }
    now = next;
  }
}

TEST(DrivenBar, VelocityIsTheDerivative) {
  const DrivenBar bar(Flexible(), From(VibrationSource::kRotors), 0.406, 1, "uav0");
  RigDrive drive = AllRotorsAt(51);
  drive.bar = BarState{};
  (*drive.bar)[0] = {1e-5, 3e-3};
  const DrivenBar::Tick tick(bar, drive);
  for (const double t_s : {0.001, 0.0123, 0.08}) {
    const double h = 1e-6;
    const BarState before = tick.At(t_s - h).bar, now = tick.At(t_s).bar,
                   after = tick.At(t_s + h).bar;
    for (int k = 0; k < 6; ++k) {
      // h² / 6 · ω³ is 1e-4 of 1e-2 m/s; rounding 1e-20 / h.
      EXPECT_NEAR(now[k].v, (after[k].x - before[k].x) / (2 * h), 1e-7);
    }
  }
}

TEST(DrivenBar, TurningSwingsTheTipsApartAndTwistsThemAlike) {
  VibrationConfig turning = From(VibrationSource::kRotors);
  turning.rotors.a_1p_mps2 = turning.rotors.a_2p_mps2 = turning.rotors.a_4p_mps2 = 0;
  const DrivenBar bar(Flexible(), turning, 0.406, 1, "uav0");
  const auto state = DrivenBar::Tick(bar, AllRotorsAt(50)).At(0.0123).bar;
  EXPECT_NE(state[0].x, 0);
  EXPECT_EQ(state[0].x, -state[3].x);
  EXPECT_EQ(state[1].x, -state[4].x);
  EXPECT_EQ(state[2].x, state[5].x);
}

// Far below the modes tips lag behind the turning root: q = -side Γ' α / ω₁², α = -d²(turn about
// down) / dt². Tones at 12 and 24 Hz: (24 / 117)² = 4 %.
TEST(DrivenBar, TipsLagBehindTheTurningRoot) {
  VibrationConfig turning = From(VibrationSource::kRotors);
  turning.rotors.a_1p_mps2 = turning.rotors.a_2p_mps2 = turning.rotors.a_4p_mps2 = 0;
  const DrivenBar bar(Flexible(), turning, 0.406, 1, "uav0");
  const DrivenBar::Tick tick(bar, AllRotorsAt(12));
  const BarModes modes = ModesOf(Flexible(), 0.406);
  const double h = 1e-4, w1 = modes.forward.frequency_radps;
  const auto turn = [&](double t_s) { return tick.At(t_s).turn_rad.y(); };
  double largest_m = 0, worst_m = 0;
  for (double t_s = 0; t_s < 1.0 / 12; t_s += 0.004) {
    const double alpha = -(turn(t_s + h) - 2 * turn(t_s) + turn(t_s - h)) / (h * h);
    const double expected_m = -modes.angular_participation_m * alpha / (w1 * w1);
    largest_m = std::max(largest_m, std::abs(expected_m));
    worst_m = std::max(worst_m, std::abs(tick.At(t_s).bar[3].x - expected_m));
  }
  EXPECT_GT(largest_m, 1e-8);
  EXPECT_LT(worst_m, 0.1 * largest_m);
}

TEST(RotorTones, PhasesSayHowFarRotorsHaveTurned) {
  const RigMotion motion = Motion(Flexible(), TonesOnly());
  RigDrive later = AllRotorsAt(50);
  later.rotor_phase_rev.fill(0.3);
  const RigDeflection turned = motion.DeflectionAt(0.004, later);
  const RigDeflection waited = motion.DeflectionAt(0.004 + 0.3 / 50, AllRotorsAt(50));
  EXPECT_NE(waited.right.up_m, 0);
  EXPECT_NEAR(turned.right.up_m, waited.right.up_m, 1e-12);
  EXPECT_NEAR(turned.left.forward_m, waited.left.forward_m, 1e-12);
}

// Stationary vibration by turning goes the same way as a rotor's: tips lag behind the root. At
// 12 Hz, far below the modes, q = -Γ' α / ω₁² with α = 2π 12 · 0.1 rad/s². Asked for in the middle
// of the record, whose ends do not join.
TEST(RigMotion, BroadbandTurningSwingsTheTipsApart) {
  std::string text;
  for (int i = 0; i < 2000; ++i) {
    text += std::to_string(i / 1000.0) + ",0,0," +
            std::to_string(0.1 * std::sin(kTwoPi * 12 * i / 1000)) + ",0,0,0\n";
  }
  VibrationConfig recorded = From(VibrationSource::kRecorded);
  const std::string file = test::ScratchFile(text, "turning");
  recorded.file = {file, file, ""};
  const RigDeflection now = Motion(Flexible(), recorded).DeflectionAt(1);
  const BarModes modes = ModesOf(Flexible(), 0.406);
  const double w1 = modes.forward.frequency_radps;
  const double expected_m = -modes.angular_participation_m * kTwoPi * 12 * 0.1 / (w1 * w1);
  // (12 / 117)² is 1 %; the record has six digits.
  EXPECT_NEAR(now.right.forward_m / expected_m, 1, 0.02);
  EXPECT_NEAR(now.left.forward_m, -now.right.forward_m, 1e-12);
}

// V1.6 for the whole rig: what the exposure sees against 1000 moments of it. The midpoint rule
// errs by (2π f T / 1000)² / 24, 1e-6 of the line at 250 Hz.
TEST(RigMotion, MeanOverTheExposureMatchesQuadrature) {
  const double exposure_s = 0.003;
  const RigMotion motion = Motion(Flexible(), From(VibrationSource::kRotors));
  const RigMotion mean = Motion(Flexible(), From(VibrationSource::kRotors), exposure_s);
  RigDrive drive = AllRotorsAt(51);
  drive.bar = BarState{};
  (*drive.bar)[3] = {2e-5, 1e-2};
  for (const double t_s : {0.0, 0.01, 0.07}) {
    RigDeflection sum;
    const int n = 1000;
    for (int i = 0; i < n; ++i) {
      const auto now = motion.DeflectionAt(t_s + exposure_s * ((i + 0.5) / n - 0.5), drive);
      sum.turn_rad += now.turn_rad / n;
      sum.right.forward_m += now.right.forward_m / n;
      sum.left.up_m += now.left.up_m / n;
      sum.left.twist_rad += now.left.twist_rad / n;
    }
    const RigDeflection closed = mean.DeflectionAt(t_s, drive);
    EXPECT_LT((closed.turn_rad - sum.turn_rad).norm(), 1e-9);
    EXPECT_NEAR(closed.right.forward_m, sum.right.forward_m, 1e-10);
    EXPECT_NEAR(closed.left.up_m, sum.left.up_m, 1e-10);
    EXPECT_NEAR(closed.left.twist_rad, sum.left.twist_rad, 1e-10);
  }
}

// V1.3 for the whole rig, and that batches change nothing.
TEST(RigMotion, ManyTimesAtOnceAreTheSameBits) {
  std::string samples;
  for (int i = 0; i < 1000; ++i) {
    samples += fmt::format("{:.3f}", i / 500.0);
    for (int axis = 0; axis < 6; ++axis)
      samples += fmt::format(",{}", std::sin(0.7 * i * i + axis));
    samples += "\n";
  }
  VibrationConfig recorded = From(VibrationSource::kRecorded);
  const std::string file = test::ScratchFile(samples, "shaking");
  recorded.file = {file, file, ""};
  RigDrive drive = AllRotorsAt(49.3);
  drive.start_s = 2;
  drive.bar = BarState{};
  std::vector<double> times_s;
  for (int i = 0; i < 37; ++i) times_s.push_back(2 + 0.0007 * ((i * 23) % 37 - 5));
  for (const VibrationConfig& vibration :
       {From(VibrationSource::kRotors), From(VibrationSource::kPsd), recorded}) {
    const RigMotion motion = Motion(Flexible(), vibration);
    const std::vector<PosedStereoRig> rigs = motion.AtMany(times_s, drive);
    for (std::size_t i = 0; i < times_s.size(); ++i) {
      const PosedStereoRig one = motion.At(times_s[i], drive);
      EXPECT_EQ(rigs[i].left.X_RC.matrix(), one.left.X_RC.matrix());
      EXPECT_EQ(rigs[i].right.X_RC.matrix(), one.right.X_RC.matrix());
    }
  }
}

// V1.7 and the levels: total acceleration of the root in m/s² against ArduPilot's limits.
TEST(VibrationPreset, LevelsAreWhatTheirNamesSay) {
  EXPECT_NEAR(std::sqrt(PowerSpectrum::MilStd810hCategory24().Power_g2(0, 1e9)), 7.694, 0.01);
  const auto total_mps2 = [](VibrationPreset preset) {
    VibrationConfig config = From(VibrationSource::kRotors);
    config.preset = preset;
    const double floor = Rms(MakeBaseVibration(config, 1, "uav0").acceleration_mps2[2]);
    const RotorToneConfig& a = config.rotors;
    const double tones = FactorsOf(preset).tones *
                         std::sqrt(2 * (a.a_1p_mps2 * a.a_1p_mps2 + a.a_2p_mps2 * a.a_2p_mps2 +
                                        a.a_4p_mps2 * a.a_4p_mps2));
    return std::hypot(floor, tones);
  };
  EXPECT_NEAR(total_mps2(VibrationPreset::kCalm), 3, 0.3);      // The quietest that is normal.
  EXPECT_NEAR(total_mps2(VibrationPreset::kNormal), 8.2, 0.1);  // Normal: 3 to 15.
  EXPECT_NEAR(total_mps2(VibrationPreset::kRough), 26, 1);      // Still accepted: below 30.
  EXPECT_NEAR(total_mps2(VibrationPreset::kMilStd810hCat24), 75.5, 1);  // Bad: above 60.
}

TEST(MakeBaseVibration, SpectrumMustReachIntoTheBand) {
  VibrationConfig config = From(VibrationSource::kPsd);
  config.min_hz = 600;
  EXPECT_THROW(MakeBaseVibration(config, 1, "uav0"), ConfigError);
  const std::string file = test::ScratchFile("1,0.1\n5,0.1\n", "slow");
  config.min_hz = 10;
  config.file = {file, file, ""};
  try {
    MakeBaseVibration(config, 1, "uav0");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.what(), file + ": must reach above vibration.min_hz = 10");
  }
}

// Every recording that lies about can be flown.
TEST(MakeBaseVibration, ReadsEveryRecordingAtHand) {
  const std::filesystem::path folder = WINDHOVER_REAL_INPUTS_DIR "/vibration";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    VibrationConfig config = From(VibrationSource::kRecorded);
    config.file = {entry.path(), entry.path(), ""};
    const BaseVibration vibration = MakeBaseVibration(config, 1, "uav0");
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GT(Rms(vibration.acceleration_mps2[axis]), 0.1) << entry.path();
      EXPECT_GT(Rms(vibration.angular_rate_radps[axis]), 1e-3) << entry.path();
    }
  }
}

}  // namespace
}  // namespace windhover
