#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "rig/drift.h"
#include "rig/driven_bar.h"
#include "rig/half_bar.h"
#include "rig/mode.h"
#include "rig/rig_motion.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kBaseline_m = 0.406, kFocal_px = 3215;
constexpr PinholeRadtan kCamera{
    .fx_px = kFocal_px, .fy_px = kFocal_px, .cx_px = 639.5, .cy_px = 359.5};
constexpr StereoRig kRig{.left = kCamera,
                         .right = kCamera,
                         .baseline_m = kBaseline_m,
                         .width_px = 1280,
                         .height_px = 720};

FlexConfig Flex(BarSectionType section, double camera_mass_kg = 0.12, double damping = 0.015) {
  FlexConfig flex;
  flex.enabled = true;
  flex.section = section;
  flex.camera_mass_kg = camera_mass_kg;
  flex.damping = damping;
  return flex;
}

HalfBar BarOf(BarSectionType section, double camera_mass_kg) {
  return MakeHalfBar(Flex(section, camera_mass_kg), kBaseline_m);
}

double ForwardFrequency_hz(const HalfBar& bar) {
  return BendingFrequency_radps(bar, bar.section.EI_forward_Nm2) / kTwoPi;
}

RigMotion Motion(const FlexConfig& flex, std::uint64_t seed = 1) {
  return {kRig, Misalignment{}, flex, VibrationConfig{}, seed, "uav0"};
}

double YawOf(const PosedCamera& camera) {
  const Vector3d axis = camera.X_RC.linear().col(2);
  return std::atan2(axis.x(), axis.z());
}

double RelativeYaw(const PosedStereoRig& rig) { return YawOf(rig.right) - YawOf(rig.left); }

// V2.1
TEST(HalfBar, EigenvaluesAreThoseOfTheTextbooks) {
  EXPECT_NEAR(CantileverEigenvalue(0), 1.875104, 1e-6);
  EXPECT_NEAR(FreeBarEigenvalue(), 4.730041, 1e-6);
  for (const double mu : {0.0, 0.3, 1.0, 10.0, 1000.0}) {
    const double b = CantileverEigenvalue(mu);
    EXPECT_NEAR(1 + std::cos(b) * std::cosh(b) +
                    b * mu * (std::cos(b) * std::sinh(b) - std::sin(b) * std::cosh(b)),
                0, 1e-11 * (1 + mu));
  }
}

// V2.1: Rayleigh's frequency is too high by 1.5 %, 0.05 % and 0.001 % (physical models, 2.1).
TEST(HalfBar, RayleighIsAsGoodAsPublished) {
  HalfBar bar = BarOf(BarSectionType::kCfTube20x18, 0);
  const std::array<std::array<double, 2>, 3> cases = {{{0, 0.015}, {1, 5e-4}, {10, 1e-5}}};
  for (const auto& [mu, error] : cases) {
    bar.tip_mass_kg = mu * bar.BeamMass_kg();
    const double excess = RayleighFrequency_radps(bar, 189) / BendingFrequency_radps(bar, 189) - 1;
    EXPECT_GT(excess, 0.5 * error) << mu;
    EXPECT_LT(excess, 1.5 * error) << mu;
  }
}

struct SectionRow {
  BarSectionType section;
  double EI_Nm2, f_80g_hz, f_150g_hz, torsion_2e5_hz, torsion_5e5_hz;
  double quasi_static_px, damping, resonance_px, thermal_px, longer_um;
};

// The table of sections (physical models, 2.2), to the digits that it gives.
TEST(HalfBar, SectionsHaveTheirPublishedNumbers) {
  const std::vector<SectionRow> rows = {
      {BarSectionType::kCfTube16x14, 93, 101, 74, 288, 182, .22, .01, 6.1, .08, .41},
      {BarSectionType::kCfTube20x18, 189, 143, 105, 411, 260, .11, .01, 3.1, .07, .41},
      {BarSectionType::kCfPlate40x3Strong, 960, 313, 234, 106, 67, .02, .01, .65, .07, .81},
      {BarSectionType::kCfPlate40x3Weak, 5.4, 24, 18, 106, 67, 4.0, .01, 116, .87, .81},
      {BarSectionType::kAlPlate40x4Weak, 14.7, 36, 28, 372, 235, 1.6, .005, 102, 7.7, 9.6},
      {BarSectionType::kAl2020, 483, 208, 160, 493, 312, .05, .005, 3.1, 1.5, 9.6}};
  for (const SectionRow& row : rows) {
    SCOPED_TRACE(static_cast<int>(row.section));
    HalfBar light = BarOf(row.section, 0.08), heavy = BarOf(row.section, 0.15);
    const double EI_Nm2 = light.section.EI_forward_Nm2;
    EXPECT_NEAR(EI_Nm2, row.EI_Nm2, 0.006 * row.EI_Nm2);
    EXPECT_NEAR(ForwardFrequency_hz(light), row.f_80g_hz, 0.6);
    EXPECT_NEAR(ForwardFrequency_hz(heavy), row.f_150g_hz, 0.6);
    light.tip_inertia_kgm2 = 2e-5;
    heavy.tip_inertia_kgm2 = 5e-5;
    EXPECT_NEAR(TorsionFrequency_radps(light) / kTwoPi, row.torsion_2e5_hz, 0.8);
    EXPECT_NEAR(TorsionFrequency_radps(heavy) / kTwoPi, row.torsion_5e5_hz, 0.8);
    const double slope_rad = StaticTipPerAcceleration(heavy, EI_Nm2).slope_rad;
    EXPECT_NEAR(2 * slope_rad * kFocal_px, row.quasi_static_px, 0.03 * row.quasi_static_px + 5e-3);
    // At resonance: relative yaw 2 · 3/(2L) · Γ a / (2 ζ ω₁²).
    const double w1 = BendingFrequency_radps(light, EI_Nm2);
    const double resonance_rad =
        3 / light.length_m * Participation(light) / (2 * row.damping * w1 * w1);
    EXPECT_NEAR(resonance_rad * kFocal_px, row.resonance_px, 0.02 * row.resonance_px);
    const BarSection& section = light.section;
    EXPECT_NEAR(section.expansion_per_K * kBaseline_m / section.depth_m * kFocal_px, row.thermal_px,
                0.03 * row.thermal_px + 5e-3);
    EXPECT_NEAR(section.expansion_per_K * kBaseline_m * 1e6, row.longer_um, 0.02 * row.longer_um);
  }
}

// The table of 1.5: frequencies of the bars that were computed there. Default: 117 Hz.
TEST(HalfBar, DefaultBarIsTheOneOfThePresets) {
  EXPECT_NEAR(ForwardFrequency_hz(MakeHalfBar(FlexConfig{}, kBaseline_m)), 117, 0.5);
  EXPECT_NEAR(ModesOf(Flex(BarSectionType::kCfTube20x18), kBaseline_m).participation, 1.02, 0.01);
}

TEST(HalfBar, GivenFrequencyAndParticipationReplaceTheComputedOnes) {
  FlexConfig flex = Flex(BarSectionType::kCfPlate40x3Strong);
  const BarModes computed = ModesOf(flex, kBaseline_m);
  EXPECT_GT(computed.forward.frequency_radps, 10 * computed.up.frequency_radps);
  flex.frequency_hz = 62;
  flex.participation = 1.01;
  const BarModes given = ModesOf(flex, kBaseline_m);
  EXPECT_DOUBLE_EQ(given.forward.frequency_radps, kTwoPi * 62);
  EXPECT_DOUBLE_EQ(given.up.frequency_radps, kTwoPi * 62);
  EXPECT_EQ(given.participation, 1.01);
  EXPECT_EQ(ModesOf(FlexConfig{}, kBaseline_m).participation, 0);
}

// V2.6: f₁ ∝ √EI; ∝ L^-1.5 where the tip's mass counts alone.
TEST(HalfBar, FrequencyScalesAsItMust) {
  HalfBar bar = BarOf(BarSectionType::kCfTube16x14, 0.15);
  EXPECT_NEAR(BendingFrequency_radps(bar, 400) / BendingFrequency_radps(bar, 100), 2, 1e-12);
  bar.section.mass_per_length_kgpm = 1e-6;
  HalfBar twice = bar;
  twice.length_m *= 2;
  EXPECT_NEAR(BendingFrequency_radps(bar, 100) / BendingFrequency_radps(twice, 100),
              std::pow(2, 1.5), 1e-4);
}

// V2.9: NODAR's bar of 1 m, here 25.4 mm of solid aluminium without cameras, at 10 g.
TEST(HalfBar, LongBarBendsAsAMakerReports) {
  const double width_m = 0.0254;
  HalfBar bar{{.EI_forward_Nm2 = 69e9 * std::pow(width_m, 4) / 12,
               .mass_per_length_kgpm = 2700 * width_m * width_m},
              0.5,
              0,
              1e-5};
  const StaticTip tip = StaticTipPerAcceleration(bar, bar.section.EI_forward_Nm2);
  EXPECT_NEAR(DegFromRad(2 * tip.slope_rad * 10 * 9.80665), 0.1704, 1e-4);
}

// V2.2: the mode's static deflection is the beam's; 0.05 % are the exact frequency's.
TEST(Mode, StepResponseEndsAtTheStaticDeflection) {
  for (const double mass_kg : {0.08, 0.15}) {
    const HalfBar bar = BarOf(BarSectionType::kCfTube16x14, mass_kg);
    const BarModes modes = ModesOf(Flex(BarSectionType::kCfTube16x14, mass_kg), kBaseline_m);
    ModeState state;
    for (int i = 0; i < 20000; ++i) {
      state = Stepped(modes.forward, state, -modes.participation, -modes.participation, 1e-3);
    }
    const double expected_m =
        StaticTipPerAcceleration(bar, bar.section.EI_forward_Nm2).deflection_m;
    EXPECT_NEAR(-state.x / expected_m, 1, 1e-3);
    EXPECT_NEAR(state.v, 0, 1e-12);
  }
}

// V2.3: the peaks of what rings fall by exp(2π ζ / √(1 - ζ²)) a period.
TEST(Mode, LogarithmicDecrementGivesTheDamping) {
  for (const double damping : {0.005, 0.015, 0.2}) {
    const Mode mode{kTwoPi * 117, damping};
    const double period_s = 1 / (117 * std::sqrt(1 - damping * damping));
    const int n = 5;
    const double decrement =
        std::log(1 / Rung(mode, {1, 0}, n * period_s).x) / n;  // It starts at a peak.
    const double recovered = decrement / std::hypot(kTwoPi, decrement);
    EXPECT_NEAR(recovered / damping, 1, 0.02);
  }
}

// V2.8: without damping the energy stays, step by step.
TEST(Mode, UndampedRingingKeepsItsEnergy) {
  const Mode mode{kTwoPi * 117, 0};
  const double w2 = mode.frequency_radps * mode.frequency_radps;
  ModeState state{1e-4, 0.02};
  const auto energy = [&] { return 0.5 * state.v * state.v + 0.5 * w2 * state.x * state.x; };
  const double before = energy();
  for (int i = 0; i < 100000; ++i) state = Stepped(mode, state, 0, 0, 0.0017);
  EXPECT_NEAR(energy() / before, 1, 1e-9);
}

TEST(Mode, CriticalDampingHasItsLimit) {
  // x = (1 + ω t) exp(-ω t) from rest at 1.
  const ModeState state = Rung({10, 1}, {1, 0}, 0.1);
  EXPECT_NEAR(state.x, 2 * std::exp(-1), 1e-12);
  EXPECT_NEAR(state.v, -10 * std::exp(-1), 1e-12);
}

TEST(Mode, RingingBackInTimeStaysBounded) {
  const ModeState state = Rung({kTwoPi * 5000, 1}, {1e-9, 0}, -0.05);
  EXPECT_TRUE(std::isfinite(state.x));
  EXPECT_TRUE(std::isfinite(MeanRung({kTwoPi * 5000, 1}, {1e-9, 0}, -0.05, 0.002)));
}

// Against classical Runge-Kutta in small steps: error 1e-10 of the answer.
TEST(Mode, StepIsExactForARampOfInput) {
  const Mode mode{40, 0.3};
  const double u0 = 3, u1 = -2, T = 0.35;
  const auto f = [&](double t, const ModeState& s) {
    const double u = u0 + (u1 - u0) * t / T;
    return ModeState{s.v, u - 2 * 0.3 * 40 * s.v - 40 * 40 * s.x};
  };
  const auto along = [](const ModeState& s, double h, const ModeState& d) {
    return ModeState{s.x + h * d.x, s.v + h * d.v};
  };
  ModeState state{0.01, -0.2};
  const ModeState exact = Stepped(mode, state, u0, u1, T);
  const int n = 20000;
  const double h = T / n;
  for (int i = 0; i < n; ++i) {
    const double t = i * h;
    const ModeState k1 = f(t, state), k2 = f(t + h / 2, along(state, h / 2, k1)),
                    k3 = f(t + h / 2, along(state, h / 2, k2)), k4 = f(t + h, along(state, h, k3));
    state = {state.x + h / 6 * (k1.x + 2 * k2.x + 2 * k3.x + k4.x),
             state.v + h / 6 * (k1.v + 2 * k2.v + 2 * k3.v + k4.v)};
  }
  EXPECT_NEAR(exact.x, state.x, 1e-12);
  EXPECT_NEAR(exact.v, state.v, 1e-10);
}

// V2.4: a sine at f₁ ends at Γ a / (2 ζ ω₁²), here by the steps of the dynamics: straight lines
// between 4096 points a period keep its amplitude to (2π / 4096)² / 12.
TEST(Mode, SineAtResonanceEndsAtTheClosedForm) {
  const BarModes modes = ModesOf(Flex(BarSectionType::kCfTube20x18), kBaseline_m);
  const Mode& mode = modes.forward;
  const double h = kTwoPi / mode.frequency_radps / 4096;
  const auto u = [&](int i) { return -modes.participation * std::cos(kTwoPi * i / 4096); };
  ModeState state;
  double largest_m = 0;
  for (int i = 0; i < 4096 * 100; ++i) {
    state = Stepped(mode, state, u(i), u(i + 1), h);
    if (i > 4096 * 98) largest_m = std::max(largest_m, std::abs(state.x));
  }
  const double closed_m = modes.participation / (2 * 0.015 * std::pow(mode.frequency_radps, 2));
  EXPECT_NEAR(largest_m / closed_m, 1, 0.02);
  EXPECT_NEAR(std::abs(Response(mode, mode.frequency_radps / kTwoPi)) * modes.participation,
              closed_m, 1e-12 * closed_m);
}

// V2.5: forward acceleration of the root, as in a hard start: cameras turn apart in yaw alone.
TEST(RigMotion, SlowForwardForceYawsTheCamerasAgainstEachOther) {
  const RigMotion motion = Motion(Flex(BarSectionType::kCfTube16x14, 0.15));
  RigDrive drive;
  drive.specific_force_B_mps2 += Vector3d(1, 0, 0);
  const PosedStereoRig rig = motion.At(0, drive);
  EXPECT_NEAR(YawOf(rig.left), -YawOf(rig.right), 1e-15);
  // 0.22 px a m/s² (physical models, 2.2); the mode's slope is 1 % from the beam's.
  EXPECT_NEAR(RelativeYaw(rig) * kFocal_px, 0.22, 0.005);
  for (const PosedCamera& camera : {rig.left, rig.right}) {
    EXPECT_NEAR(camera.X_RC.linear()(1, 2), 0, 1e-15);  // Pitch.
    EXPECT_NEAR(camera.X_RC.linear()(1, 0), 0, 1e-15);  // Roll.
  }
  const double baseline_m = (rig.right.X_RC.translation() - rig.left.X_RC.translation()).norm();
  EXPECT_NEAR(baseline_m, kBaseline_m, 1e-9);
}

// The rig was calibrated on the ground, sagging: level flight bends nothing, free fall lifts the
// tips by as much as gravity bent them.
TEST(RigMotion, OnlyWhatDiffersFromLevelFlightBends) {
  const FlexConfig flex = Flex(BarSectionType::kCfPlate40x3Strong);
  const RigMotion motion = Motion(flex);
  EXPECT_EQ(motion.DeflectionAt(3).right.up_m, 0);
  RigDrive falling;
  falling.specific_force_B_mps2.setZero();
  const HalfBar bar = MakeHalfBar(flex, kBaseline_m);
  const double sag_m = 9.80665 * StaticTipPerAcceleration(bar, bar.section.EI_up_Nm2).deflection_m;
  EXPECT_NEAR(motion.DeflectionAt(3, falling).left.up_m / sag_m, 1, 1e-3);
}

// V2.7
TEST(RigMotion, ThermalGradientYawsInProportion) {
  FlexConfig flex = Flex(BarSectionType::kAlPlate40x4Weak);
  flex.thermal_gradient_K = 1;
  EXPECT_NEAR(RelativeYaw(Motion(flex).At(7)) * kFocal_px, 7.7, 0.05);
  const double one_rad = RelativeYaw(Motion(flex).At(7));
  flex.thermal_gradient_K = -3;
  EXPECT_NEAR(RelativeYaw(Motion(flex).At(7)), -3 * one_rad, 1e-12);
  flex.section = BarSectionType::kCustom;
  flex.custom.expansion_per_K = 0;
  EXPECT_EQ(RelativeYaw(Motion(flex).At(7)), 0);
}

TEST(RigMotion, WarmBarIsLonger) {
  FlexConfig flex = Flex(BarSectionType::kAl2020);
  flex.thermal_mean_K = 20;
  const PosedStereoRig rig = Motion(flex).At(0);
  const Vector3d baseline_m = rig.right.X_RC.translation() - rig.left.X_RC.translation();
  EXPECT_NEAR(baseline_m.x() - kBaseline_m, 23.6e-6 * 20 * kBaseline_m, 1e-12);
  EXPECT_EQ(RelativeYaw(rig), 0);
}

TEST(RigMotion, HardLandingTurnsTheCamerasForGood) {
  FlexConfig flex = Flex(BarSectionType::kCfTube20x18);
  flex.landing = {.time_s = 3, .yaw_deg = 0.2, .pitch_deg = 0.1, .roll_deg = -0.05};
  const RigMotion motion = Motion(flex);
  EXPECT_EQ(RelativeYaw(motion.At(2.999)), 0);
  for (const double t_s : {3.0, 100.0}) {
    EXPECT_NEAR(DegFromRad(RelativeYaw(motion.At(t_s))), 0.2, 1e-5);
    EXPECT_NEAR(DegFromRad(motion.DeflectionAt(t_s).relative_turn_rad.x()), 0.1, 1e-12);
  }
}

TEST(RigMotion, DriftHasItsSize) {
  FlexConfig flex = Flex(BarSectionType::kCfTube20x18);
  flex.drift = {.yaw_sigma_deg = 0.01};
  double sum = 0;
  const int n = 2000;  // Relative error of a variance: √(2 / n) = 3 %.
  for (int seed = 0; seed < n; ++seed) {
    const double yaw_deg = DegFromRad(RelativeYaw(Motion(flex, seed).At(40)));
    sum += yaw_deg * yaw_deg / n;
  }
  EXPECT_NEAR(sum / 1e-4, 1, 0.12);
}

// Over 4000 seeds a correlation is known to 1.6 %, a variance to 2.2 %; four of these each.
TEST(OrnsteinUhlenbeck, HasItsVarianceAndCorrelationTime) {
  const double tau_s = 300;
  const std::array<double, 5> times_s = {0, 10.3, 150, 310.3, 3000};
  Eigen::Matrix<double, 5, 5> moments = Eigen::Matrix<double, 5, 5>::Zero();
  const int n = 4000;
  for (int seed = 0; seed < n; ++seed) {
    const OrnsteinUhlenbeck process(2, tau_s, RandomStream(seed, "drift"));
    Eigen::Matrix<double, 5, 1> x;
    for (int i = 0; i < 5; ++i) x[i] = process.At(times_s[i]);
    moments += x * x.transpose() / n;
  }
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const double lag_s = std::abs(times_s[i] - times_s[j]);
      EXPECT_NEAR(moments(i, j) / 4, std::exp(-lag_s / tau_s), 0.09) << i << j;
    }
  }
}

// One long path: the correlation of neighbours gives τ.
TEST(OrnsteinUhlenbeck, OnePathHasTheCorrelationTimeToo) {
  const OrnsteinUhlenbeck process(1, 5, RandomStream(3, "drift"));
  double xx = 0, xy = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = process.At(i), y = process.At(i + 1);
    xx += x * x;
    xy += x * y;
  }
  // The correlation of 1e5 samples: √((1 - ρ²) / n) = 0.002, in τ 5 %.
  EXPECT_NEAR(-1 / std::log(xy / xx), 5, 0.3);
  EXPECT_NEAR(xx / 1e5, 1, 0.05);
}

// The first 512 s have a shorter way to the same path: both sides of their end are halves of one.
TEST(OrnsteinUhlenbeck, GoesOnWhereTheFirstMinutesEnd) {
  for (const double tau_s : {0.5, 5.0, 300.0, 60000.0}) {
    const OrnsteinUhlenbeck process(1, tau_s, RandomStream(3, "drift"));
    // Straight lines between moments tau / 128 or less apart: of slope below 8 sigma over that.
    EXPECT_NEAR(process.At(512 - 1e-9), process.At(512), 8e-9 * 128 * 2 / tau_s);
    EXPECT_NEAR(process.At(512 + 1e-9), process.At(512), 8e-9 * 128 * 2 / tau_s);
  }
}

TEST(OrnsteinUhlenbeck, IsContinuousAndBoundedInTime) {
  const OrnsteinUhlenbeck process(1, 300, RandomStream(3, "drift"));
  EXPECT_NEAR(process.At(100), process.At(100 + 1e-9), 1e-9);
  EXPECT_EQ(process.At(-1), process.At(0));
  EXPECT_EQ(process.At(1e9), process.At(131072));
}

}  // namespace
}  // namespace windhover
