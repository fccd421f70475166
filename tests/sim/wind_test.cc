#include "sim/wind.h"

#include <cmath>
#include <complex>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace windhover {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector3d;

constexpr double kSpeed_mps = 5;

// At 10 m in moderate turbulence's 15 kt of light: the worked example of the design.
DrydenScales Scales() { return DrydenScalesAt(10, 15 * 0.514444); }

std::vector<Vector3d> Gusts(int n, double dt_s, std::uint64_t seed = 1) {
  DrydenGusts gusts(seed, "uav0", 0);
  std::vector<Vector3d> out;
  for (int i = 0; i < n; ++i) out.push_back(gusts.Step(dt_s, kSpeed_mps, Scales()));
  return out;
}

TEST(Dryden, ScalesAtTenMetresInFifteenKnots) {
  EXPECT_NEAR(Scales().L_u_m, 67, 0.5);
  EXPECT_NEAR(Scales().L_w_m, 10, 1e-9);
  EXPECT_NEAR(Scales().sigma_u_mps, 1.46, 0.005);
  EXPECT_NEAR(Scales().sigma_w_mps, 0.77, 0.005);
  // Below 10 and above 1000 ft the ends hold; at 1000 ft turbulence is isotropic.
  EXPECT_EQ(DrydenScalesAt(-5, 10).L_w_m, 10 * 0.3048);
  EXPECT_NEAR(DrydenScalesAt(5000, 10).L_u_m, 304.8, 1e-9);
  EXPECT_NEAR(DrydenScalesAt(5000, 10).sigma_u_mps, 1, 1e-9);
}

// V6.6: the covariance of the states is a quarter of unity after any step, so that the variance
// of a gust, σ² c P cᵀ with c = (1, √3), is σ².
TEST(Dryden, VarianceIsExactForAnyStep) {
  const Matrix2d P = Matrix2d::Identity() / 4;
  const Eigen::RowVector2d c(1, std::sqrt(3));
  EXPECT_NEAR((c * P * c.transpose()).value(), 1, 1e-12);
  for (double r = 1e-8; r < 100; r *= 1.7) {
    const GustStep step = GustStepOf(r);
    const Matrix2d after = step.phi * P * step.phi.transpose() + step.chol * step.chol.transpose();
    EXPECT_LT((after - P).norm(), 1e-12) << r;
  }
}

// V6.6: two half steps are one step, in the mean and in the noise.
TEST(Dryden, StepsAddUp) {
  for (const double r : {1e-4, 0.01, 0.5, 3.0}) {
    const GustStep whole = GustStepOf(r), half = GustStepOf(r / 2);
    EXPECT_LT((half.phi * half.phi - whole.phi).norm(), 1e-14);
    const Matrix2d added = half.chol * half.chol.transpose();
    const Matrix2d twice = half.phi * added * half.phi.transpose() + added;
    EXPECT_LT((twice - whole.chol * whole.chol.transpose()).norm(), 1e-14);
  }
}

// Sources of the shapes: u has correlation exp(-t / T), w has exp(-t / T) (1 - t / 2T).
// V6.6: sample moments are the same for steps of 10 and of 250 ms.
TEST(Dryden, SamplesHaveTheirMomentsWhateverTheStep) {
  const DrydenScales scales = Scales();
  const double T_u = scales.L_u_m / kSpeed_mps, T_w = scales.L_w_m / kSpeed_mps, lag_s = 1;
  for (const double dt_s : {0.01, 0.25}) {
    const int n = static_cast<int>(1e6), lag = static_cast<int>(std::lround(lag_s / dt_s));
    // 1e6 steps of 10 ms are 370 times 2 T_u: their variance is good to 7 %, that of w, with a
    // seventh of T, to 2 %; those of 250 ms five times better.
    const double tolerance_u = dt_s < 0.1 ? 0.25 : 0.03, tolerance_w = dt_s < 0.1 ? 0.06 : 0.03;
    const std::vector<Vector3d> gusts = Gusts(n, dt_s);
    Vector3d squares = Vector3d::Zero(), lagged = Vector3d::Zero();
    for (int i = 0; i + lag < n; ++i) {
      squares += gusts[i].cwiseAbs2();
      lagged += gusts[i].cwiseProduct(gusts[i + lag]);
    }
    const Vector3d variance = squares / (n - lag), correlation = lagged.cwiseQuotient(squares);
    EXPECT_NEAR(variance[0] / std::pow(scales.sigma_u_mps, 2), 1, tolerance_u) << dt_s;
    EXPECT_NEAR(variance[1] / std::pow(scales.sigma_u_mps, 2), 1, tolerance_u) << dt_s;
    EXPECT_NEAR(variance[2] / std::pow(scales.sigma_w_mps, 2), 1, tolerance_w) << dt_s;
    EXPECT_NEAR(correlation[0], std::exp(-lag_s / T_u), 0.02) << dt_s;
    const double x = lag_s / T_w;
    EXPECT_NEAR(correlation[2], std::exp(-x) * (1 - x / 2), 0.02) << dt_s;
  }
}

// From the first step on: 4000 flights know a variance to 2.2 %, four times which is allowed.
TEST(Dryden, BlowsAsHardAtTheStart) {
  constexpr int kFlights = 4000;
  const DrydenScales scales = Scales();
  Vector3d squares = Vector3d::Zero();
  for (std::uint64_t seed = 0; seed < kFlights; ++seed) {
    squares += DrydenGusts(seed, "uav0", 0).Step(1e-3, kSpeed_mps, scales).cwiseAbs2();
  }
  const Vector3d sigma_mps(scales.sigma_u_mps, scales.sigma_u_mps, scales.sigma_w_mps);
  const Vector3d ratio = (squares / kFlights).cwiseQuotient(sigma_mps.cwiseAbs2());
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(ratio[axis], 1, 0.09) << axis;
}

// One-sided power spectral density of component `axis` at `f_hz`: mean periodogram of pieces of
// 80 s under a Hann window.
double MeasuredPsd(const std::vector<Vector3d>& gusts, double dt_s, int axis, double f_hz) {
  const int n = static_cast<int>(80 / dt_s);
  double sum = 0, window_squares = 0;
  int n_pieces = 0;
  for (std::size_t begin = 0; begin + n <= gusts.size(); begin += n / 2, ++n_pieces) {
    std::complex<double> line = 0;
    for (int i = 0; i < n; ++i) {
      const double window = 0.5 - 0.5 * std::cos(2 * M_PI * i / n);
      line += window * gusts[begin + i][axis] * std::polar(1.0, -2 * M_PI * f_hz * i * dt_s);
      if (begin == 0) window_squares += window * window;
    }
    sum += std::norm(line);
  }
  return 2 * dt_s * sum / (n_pieces * window_squares);
}

// V6.6
TEST(Dryden, SpectrumIsThatOfTheStandard) {
  constexpr double kStep_s = 0.05;
  const DrydenScales scales = Scales();
  // 16000 s: 400 pieces, half of them independent: 7 % of deviation; 15 % is two of them.
  const std::vector<Vector3d> gusts = Gusts(320'000, kStep_s);
  for (const double f_hz : {0.05, 0.1, 0.3, 1.0}) {
    const double w = 2 * M_PI * f_hz;
    const auto second_order = [&](double sigma, double T) {
      const double x = w * w * T * T;
      return 2 * sigma * sigma * T * (1 + 3 * x) / ((1 + x) * (1 + x));
    };
    const double T_u = scales.L_u_m / kSpeed_mps, T_w = scales.L_w_m / kSpeed_mps;
    const double psd_u =
        4 * scales.sigma_u_mps * scales.sigma_u_mps * T_u / (1 + w * w * T_u * T_u);
    EXPECT_NEAR(MeasuredPsd(gusts, kStep_s, 0, f_hz) / psd_u, 1, 0.15) << f_hz;
    EXPECT_NEAR(MeasuredPsd(gusts, kStep_s, 1, f_hz) / second_order(scales.sigma_u_mps, T_u), 1,
                0.15)
        << f_hz;
    EXPECT_NEAR(MeasuredPsd(gusts, kStep_s, 2, f_hz) / second_order(scales.sigma_w_mps, T_w), 1,
                0.15)
        << f_hz;
  }
}

TEST(Dryden, NeighboursShareWhatTheScenarioSays) {
  for (const double correlation : {0.0, 0.6, 1.0}) {
    DrydenGusts a(1, "uav0", correlation), b(1, "uav1", correlation);
    double products = 0, squares = 0;
    for (int i = 0; i < 100'000; ++i) {
      const Vector3d gust = a.Step(0.5, kSpeed_mps, Scales());
      products += gust.z() * b.Step(0.5, kSpeed_mps, Scales()).z();
      squares += gust.z() * gust.z();
    }
    EXPECT_NEAR(products / squares, correlation, 0.03);  // 5e4 s are 12 000 times 2 T_w: 1 %.
  }
}

TEST(Wind, IsTheMeanWithGustsAlongIt) {
  WindConfig config;
  config.mean_mps = {0, 3, 0};
  Wind steady(config, 1, "uav0");
  EXPECT_EQ(steady.Step(0.002, 20, {1, 2, 3}), Vector3d(0, 3, 0));
  config.turbulence = Turbulence::kLight;
  Wind gusty(config, 1, "uav0");
  DrydenGusts gusts(1, "uav0", 0);
  for (int i = 0; i < 50; ++i) {
    // Through air of 3 m/s towards north, still: 3 m/s pass by. Along is north, left of it west.
    const Vector3d gust = gusts.Step(0.1, 3, DrydenScalesAt(20, 15 * 0.514444));
    const Vector3d wind = gusty.Step(0.1, 20, {0, 0, 0});
    EXPECT_LT((wind - Vector3d(-gust.y(), 3 + gust.x(), gust.z())).norm(), 1e-9);
  }
  // South at 5 m/s into it: 8 m/s pass by.
  const Vector3d gust = gusts.Step(0.1, 8, DrydenScalesAt(20, 15 * 0.514444));
  const Vector3d wind = gusty.Step(0.1, 20, {0, -5, 0});
  EXPECT_LT((wind - Vector3d(-gust.y(), 3 + gust.x(), gust.z())).norm(), 1e-9);
}

}  // namespace
}  // namespace windhover
