#include "sim/uwb_ranging.h"

#include <cmath>
#include <functional>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "common/ranging/two_way_ranging.h"

namespace windhover {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Scenario TwoAircraft(double sigma_m = 0) {
  Scenario scenario;
  scenario.aircraft.resize(2);
  scenario.aircraft[0].self.id = 3;
  scenario.aircraft[1].self.id = 8;
  scenario.uwb.sigma_m = sigma_m;
  return scenario;
}

Kinematics At(const Vector3d& p_WB_m, const Quaterniond& q_WB = Quaterniond::Identity()) {
  Kinematics state;
  state.p_WB_m = p_WB_m;
  state.q_WB = q_WB;
  return state;
}

double RangeOf(UwbRanging& uwb, std::int64_t image = 0) {
  return uwb.Report(0, image).ranges[0].range_m;
}

// The target moves along east: 20 m + 8 m sin(0.5 t), up to 4 m/s.
Kinematics Swinging(double t_s) {
  Kinematics state = At({20 + 8 * std::sin(0.5 * t_s), 0, 0});
  state.v_WB_mps.x() = 4 * std::cos(0.5 * t_s);
  return state;
}

struct Residual {
  double range_rate_mps, error_m;
};

// What the label is off by over a minute of Swinging, 10 images per second.
std::vector<Residual> ResidualsOf(const Scenario& scenario) {
  UwbRanging uwb(scenario);
  std::vector<Residual> residuals;
  for (int k = 0; k < 630; ++k) {
    const Kinematics target = Swinging(0.1 * k);
    uwb.Observe(100'000 * k, {At(Vector3d::Zero()), target});
    residuals.push_back({target.v_WB_mps.x(), RangeOf(uwb, k) - target.p_WB_m.x()});
  }
  return residuals;
}

// Least squares of error = b − τ · rate: {b, τ}.
Eigen::Vector2d Regression(const std::vector<Residual>& residuals) {
  Eigen::MatrixX2d lines(residuals.size(), 2);
  Eigen::VectorXd errors(residuals.size());
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    lines.row(i) << 1, -residuals[i].range_rate_mps;
    errors[i] = residuals[i].error_m;
  }
  return lines.colPivHouseholderQr().solve(errors);
}

// V5.1
TEST(UwbRanging, WithoutErrorsIsTheDistance) {
  Scenario scenario = TwoAircraft();
  UwbRanging uwb(scenario);
  uwb.Observe(0, {At({1, 2, 3}), At({4, 6, 3})});
  const uwb_t report = uwb.Report(1, 0);
  EXPECT_EQ(report.id, 8);
  ASSERT_EQ(report.n_ranges, 1);
  EXPECT_EQ(report.ranges[0].target_id, 3);
  EXPECT_DOUBLE_EQ(report.ranges[0].range_m, 5);  // a 3-4-5 triangle
  scenario.uwb.bias_m = 0.25;
  UwbRanging biased(scenario);
  for (double d_m = 0.5; d_m < 100; d_m *= 1.7) {
    biased.Observe(static_cast<Utime>(d_m * 1e6), {At({0, 0, d_m}), At({d_m, 0, 0})});
    EXPECT_NEAR(RangeOf(biased), std::sqrt(2) * d_m + 0.25, 1e-12);
  }
}

// V5.2: timestamps of clocks 10 ppm apart, 200 us of reply.
TEST(TwoWayRanging, SingleSidedFeelsTheClocksDoubleSidedDoesNot) {
  for (const double distance_m : {3.0, 40.0}) {
    const RangingExchange exchange{distance_m, 6, -4, 200e-6};
    // ½ c Δe T = 0.29979 m; the clocks' errors also act on the distance itself: 4e-4 m at 40 m.
    EXPECT_NEAR(SingleSidedRange_m(exchange) - distance_m, 0.29979, 5e-4);
    const RangingExchange both_fast{distance_m, 20, 20, 200e-6};
    EXPECT_NEAR(SingleSidedRange_m(both_fast) - distance_m, 0, 1e-3);
    EXPECT_LT(std::abs(DoubleSidedRange_m(both_fast) - distance_m), 2e-3);
    EXPECT_LT(std::abs(DoubleSidedRange_m({distance_m, 20, -20, 200e-6}) - distance_m), 2e-3);
    // e · D of the clocks' mean error, 20 ppm here.
    EXPECT_NEAR(DoubleSidedRange_m(both_fast) - distance_m, 20e-6 * distance_m, 1e-6);
    EXPECT_NEAR(DoubleSidedRange_m({distance_m, 0, 0, 200e-6}), distance_m, 1e-9);
  }
}

TEST(TwoWayRanging, ReachesTheRangesThroughTheScenario) {
  Scenario scenario = TwoAircraft();
  scenario.uwb.ranging = Ranging::kSingleSided;
  UwbRanging uwb(scenario);
  uwb.Observe(0, {At({0, 0, 0}), At({10, 0, 0})});
  const double there_m = RangeOf(uwb) - 10, back_m = uwb.Report(1, 0).ranges[0].range_m - 10;
  EXPECT_GT(std::abs(there_m), 0.01);   // About 0.4 m typically; this seed's is not near 0.
  EXPECT_NEAR(there_m, -back_m, 1e-3);  // The other radio's clock is the slow one.
  scenario.uwb.ranging = Ranging::kDoubleSided;
  UwbRanging cured(scenario);
  cured.Observe(0, {At({0, 0, 0}), At({10, 0, 0})});
  EXPECT_NEAR(RangeOf(cured), 10, 1e-3);
}

TEST(PowerBias, IsTheTableAtItsPoints) {
  // -77 dBm, where the curve crosses 0: 62.7 dB of free space at 6.49 GHz are 5.02 m.
  EXPECT_NEAR(PowerBias_m(5.02), 0, 1e-3);
  EXPECT_NEAR(PowerBias_m(1e-6), -0.11, 1e-12);
  EXPECT_NEAR(PowerBias_m(1e6), 0.081, 1e-12);
  for (double d_m = 0.5; d_m < 40; d_m *= 1.1) {
    EXPECT_GE(PowerBias_m(1.1 * d_m), PowerBias_m(d_m)) << d_m;
    EXPECT_LT(std::abs(PowerBias_m(d_m)), 0.111);
  }
}

// V5.3
TEST(UwbRanging, NoiseHasItsMomentsAndNlosOnlyLengthens) {
  constexpr int kSamples = 100'000;
  constexpr double kSigma_m = 0.05, kFraction = 0.2, kMean_m = 0.3;
  Scenario scenario = TwoAircraft(kSigma_m);
  scenario.uwb.bias_m = 0.1;
  UwbRanging clear(scenario);
  scenario.uwb.nlos_fraction = kFraction;
  scenario.uwb.nlos_mean_m = kMean_m;
  UwbRanging cluttered(scenario);
  double sum = 0, squares = 0, excess_sum = 0;
  int n_long = 0;
  for (int k = 0; k < kSamples; ++k) {
    // A second apart, as long as a burst: 1e5 samples are near to independent.
    const Utime utime = 1'000'000 * Utime{k};
    const std::vector<Kinematics> states = {At({0, 0, 0}), At({30, 0, 0})};
    clear.Observe(utime, states);
    cluttered.Observe(utime, states);
    const double error_m = RangeOf(clear, k) - 30, excess_m = RangeOf(cluttered, k) - 30 - error_m;
    sum += error_m;
    squares += (error_m - 0.1) * (error_m - 0.1);
    excess_sum += excess_m;
    n_long += excess_m > 1e-9 ? 1 : 0;
    ASSERT_GT(error_m + excess_m - 0.1, -5 * kSigma_m);  // 1e5 draws reach -4.3 sigma.
    ASSERT_GT(excess_m, -1e-12);
  }
  EXPECT_NEAR(sum / kSamples, 0.1, 0.05 * 0.1);
  EXPECT_NEAR(std::sqrt(squares / kSamples), kSigma_m, 0.05 * kSigma_m);
  EXPECT_NEAR(1.0 * n_long / kSamples, kFraction, 0.05 * kFraction);
  EXPECT_NEAR(excess_sum / n_long, kMean_m, 0.05 * kMean_m);
}

TEST(Obstruction, ComesInBurstsOfTheirMeanLength) {
  Obstruction obstruction(0.2, 2, RandomStream(1, "test"));
  int n_on = 0, n_starts = 0;
  bool was = false;
  constexpr int kSteps = 1'000'000;  // 2e4 s at 20 ms: 2000 bursts, 2.2 % of their mean.
  for (int k = 0; k < kSteps; ++k) {
    const bool is = obstruction.At(0.02 * k);
    n_on += is ? 1 : 0;
    n_starts += is && !was ? 1 : 0;
    was = is;
  }
  EXPECT_NEAR(0.02 * n_on / n_starts, 2, 0.2);
  EXPECT_NEAR(1.0 * n_on / kSteps, 0.2, 0.02);
  // In any order of asking.
  Obstruction again(0.2, 2, RandomStream(1, "test"));
  for (const double t_s : {900.0, 3.0, 500.0, -1.0}) EXPECT_EQ(again.At(t_s), obstruction.At(t_s));
}

TEST(UwbRanging, OutliersAreAsManyAndAsLargeAsAskedFor) {
  Scenario scenario = TwoAircraft();
  scenario.uwb.outlier_rate = 0.1;
  scenario.uwb.outlier_m = 5;
  UwbRanging uwb(scenario);
  uwb.Observe(0, {At({0, 0, 0}), At({30, 0, 0})});
  int n = 0;
  for (int k = 0; k < 10'000; ++k) {
    const double error_m = std::abs(RangeOf(uwb, k) - 30);
    EXPECT_LE(error_m, 5);
    n += error_m > 1e-9 ? 1 : 0;
  }
  EXPECT_NEAR(n, 1000, 4 * std::sqrt(1000 * 0.9));
}

// V5.4
TEST(UwbRanging, RegressionOnTheRangeRateFindsTheLatency) {
  for (const double rate_hz : {0.0, 50.0}) {
    for (const double latency_s : {0.0, 0.02, 0.1}) {
      Scenario scenario = TwoAircraft();
      scenario.uwb.rate_hz = rate_hz;
      scenario.uwb.label = UwbLabel::kInterpolated;
      scenario.uwb.latency_s = latency_s;
      EXPECT_NEAR(Regression(ResidualsOf(scenario))[1], latency_s, 1e-3) << rate_hz;
    }
  }
}

// The nearest of samples 20 ms apart is at most 10 ms away, at 4 m/s 40 mm; a clock 100 ppm fast
// is 6 ms ahead after a minute.
TEST(UwbRanging, NearestSampleAndDriftAreOffByWhatTheyShould) {
  Scenario scenario = TwoAircraft();
  scenario.uwb.rate_hz = 47;
  double largest_m = 0;
  for (const Residual& residual : ResidualsOf(scenario)) {
    largest_m = std::max(largest_m, std::abs(residual.error_m));
  }
  EXPECT_LT(largest_m, 4 * 0.5 / 47 + 1e-3);
  EXPECT_GT(largest_m, 0.9 * 4 * 0.5 / 47);
  scenario.uwb.rate_hz = 0;
  scenario.uwb.drift_ppm = 100;
  const Residual last = ResidualsOf(scenario).back();
  EXPECT_NEAR(last.error_m, -last.range_rate_mps * 62.9e-4, 1e-4);
}

TEST(UwbRanging, JitterOfStampsIsNoiseOfMovingTargetsOnly) {
  Scenario scenario = TwoAircraft();
  scenario.uwb.jitter_s = 0.005;
  for (const double rate_hz : {0.0, 200.0}) {
    scenario.uwb.rate_hz = rate_hz;
    double squares = 0, rates = 0;
    for (const Residual& residual : ResidualsOf(scenario)) {
      squares += residual.error_m * residual.error_m;
      rates += residual.range_rate_mps * residual.range_rate_mps;
    }
    // One sample per image is off by its own jitter; of many, the nearest stamp's time of taking
    // is spread alike. 630 of them tell a deviation to 3 %; a period of 5 ms adds 1.4 ms rms.
    EXPECT_NEAR(std::sqrt(squares / rates), 0.005, 0.005 * 0.12) << rate_hz;
  }
}

// V5.5
TEST(UwbRanging, LeverArmsTurnWithTheAircraft) {
  Scenario scenario = TwoAircraft();
  scenario.uwb.antenna_m = {0, 0, 0.1};
  scenario.aircraft[0].uwb_antenna_m = {-0.2, 0, 0.05};
  UwbRanging uwb(scenario);
  const Vector3d own_B_m(-0.2, 0, 0.15), target_B_m(0, 0, 0.1);
  Utime utime = 0;
  for (double roll = -0.6; roll <= 0.6; roll += 0.3) {
    for (double pitch = -0.6; pitch <= 0.6; pitch += 0.3) {
      const Quaterniond q_o(RotationFromVector({roll, pitch, 0.7}));
      const Quaterniond q_t(RotationFromVector({pitch, -roll, -2}));
      const Vector3d between_m(12, -9, 20);  // 25 m
      uwb.Observe(utime += 1000, {At({0, 0, 0}, q_o), At(between_m, q_t)});
      const Vector3d lever_m = q_t * target_B_m - q_o * own_B_m;
      EXPECT_NEAR(RangeOf(uwb), (between_m + lever_m).norm(), 1e-12);
      // To first order û · lever; the second is lever² / (2 · 25 m) at most.
      EXPECT_NEAR(RangeOf(uwb) - 25, between_m.normalized().dot(lever_m), 0.35 * 0.35 / 50);
    }
  }
}

// 0.1 m of mast, tilted by 20 degrees towards the other aircraft: 34 mm.
TEST(UwbRanging, ATiltedMastShiftsTheRange) {
  Scenario scenario = TwoAircraft();
  scenario.aircraft[1].uwb_antenna_m = {0, 0, 0.1};
  UwbRanging uwb(scenario);
  const Quaterniond tilted(RotationFromVector({0, RadFromDeg(20), 0}));
  uwb.Observe(0, {At({0, 0, 0}), At({40, 0, 0}, tilted)});
  EXPECT_NEAR(RangeOf(uwb) - 40, 0.0342, 2e-4);
}

// V5.6: from a noisy flight, least squares find the constant error and the latency of this seed.
TEST(UwbRanging, AFlightTellsItsConstantErrorAndItsLatency) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    Scenario scenario = TwoAircraft();
    scenario.random_seed = seed;
    scenario.uwb.antenna_delay_sigma_m = 0.15;
    scenario.uwb.latency_sigma_s = 0.1;
    const double constant_m = Regression(ResidualsOf(scenario))[0];
    scenario.uwb.sigma_m = 0.05;
    const Eigen::Vector2d found = Regression(ResidualsOf(scenario));
    // 630 samples of 0.05 m pin a mean to 2 mm and, at 2.8 m/s rms, a time to 0.7 ms: 4 sigma.
    EXPECT_NEAR(found[0], constant_m, 0.008) << seed;
    EXPECT_NEAR(found[1], UwbRanging(scenario).Latency_s(0), 0.003) << seed;
    EXPECT_GT(std::abs(constant_m), 1e-3);
  }
}

TEST(UwbRanging, ErrorsOfAFlightBelongToSeedAndPair) {
  Scenario scenario = TwoAircraft();
  scenario.aircraft.emplace_back().self.id = 9;
  scenario.uwb.antenna_delay_sigma_m = 0.1;
  const std::vector<Kinematics> states = {At({0, 0, 0}), At({3, 4, 0}), At({-3, 4, 0})};
  UwbRanging a(scenario), b(scenario);
  a.Observe(0, states);
  b.Observe(0, states);
  b.Report(2, 5);
  EXPECT_EQ(RangeOf(a, 1), RangeOf(b, 1));
  EXPECT_EQ(RangeOf(a, 1), RangeOf(a, 2));                     // Constant in a flight,
  EXPECT_EQ(RangeOf(a, 1), a.Report(1, 1).ranges[0].range_m);  // alike both ways,
  EXPECT_NE(RangeOf(a, 1), a.Report(0, 1).ranges[1].range_m);  // not for another pair,
  scenario.random_seed = 77;
  UwbRanging other(scenario);
  other.Observe(0, states);
  EXPECT_NE(RangeOf(a, 1), RangeOf(other, 1));  // nor in another flight.
}

TEST(StateHistory, InterpolatesACubicExactlyAndGoesOnOutside) {
  // x = t³ between 1 and 2 s, seen at both ends only.
  StateHistory history;
  for (const double t_s : {1.0, 2.0}) {
    Kinematics state = At({t_s * t_s * t_s, 0, 0});
    state.v_WB_mps.x() = 3 * t_s * t_s;
    state.q_WB = Eigen::AngleAxisd(t_s, Vector3d::UnitZ());
    history.Add(t_s, state);
  }
  EXPECT_NEAR(history.At(1.3).p_WB_m.x(), 1.3 * 1.3 * 1.3, 1e-12);
  EXPECT_NEAR(history.At(1.3).v_WB_mps.x(), 3 * 1.3 * 1.3, 1e-12);
  EXPECT_NEAR(history.At(1.3).q_WB.angularDistance(Quaterniond::Identity()), 1.3, 1e-12);
  EXPECT_EQ(history.At(2).p_WB_m.x(), 8);
  EXPECT_NEAR(history.At(2.5).p_WB_m.x(), 8 + 0.5 * 12, 1e-12);
  EXPECT_NEAR(history.At(0.5).p_WB_m.x(), 1 - 0.5 * 3, 1e-12);
  history.ForgetBefore(1.5);
  EXPECT_NEAR(history.At(1.5).p_WB_m.x(), 1.5 * 1.5 * 1.5, 1e-12);
}

}  // namespace
}  // namespace windhover
