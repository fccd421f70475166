#include "rig/bending.h"

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace windhover {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr FlexConfig kFlex{
    .enabled = true, .frequency_hz = 117, .damping = 0.015, .participation = 1.05};

TEST(BendingResponse, IsStaticBelowResonance) {
  // q = -Γ a / ω₁²: the tip lags the root. 1 m/s² bends it by 1.94 um at 117 Hz.
  const auto response = BendingResponse(kFlex, 1e-6);
  EXPECT_NEAR(response.real(), -1.943e-6, 1e-9);
  EXPECT_NEAR(std::arg(-response), 0, 1e-9);
}

TEST(BendingResponse, ResonanceIsOneOverTwiceTheDamping) {
  const double w1 = kTwoPi * 117;
  EXPECT_NEAR(std::abs(BendingResponse(kFlex, 117)), 1.05 / (2 * 0.015 * w1 * w1), 1e-15);
}

TEST(BendingResponse, StiffBarDoesNotBend) {
  EXPECT_EQ(BendingResponse(FlexConfig{}, 117), std::complex<double>(0));
}

// Steady state of q̈ + 2 ζ ω₁ q̇ + ω₁² q = -Γ cos ωt, integrated by Runge-Kutta from rest for
// long enough that exp(-ζ ω₁ t) is 2e-10.
TEST(BendingResponse, MatchesTheDifferentialEquation) {
  const double w1 = kTwoPi * kFlex.frequency_hz;
  for (const double frequency_hz : {40.0, 110.0, 117.0, 125.0, 300.0}) {
    const double w = kTwoPi * frequency_hz, h = 2e-5;
    const auto f = [&](double t, const std::array<double, 2>& x) {
      return std::array<double, 2>{x[1], -kFlex.participation * std::cos(w * t) -
                                             2 * kFlex.damping * w1 * x[1] - w1 * w1 * x[0]};
    };
    std::array<double, 2> x{};
    double t = 0;
    const auto step = [](const std::array<double, 2>& a, double s, const std::array<double, 2>& b) {
      return std::array<double, 2>{a[0] + s * b[0], a[1] + s * b[1]};
    };
    for (int i = 0; i < 100000; ++i, t = i * h) {
      const auto k1 = f(t, x), k2 = f(t + h / 2, step(x, h / 2, k1)),
                 k3 = f(t + h / 2, step(x, h / 2, k2)), k4 = f(t + h, step(x, h, k3));
      for (int j = 0; j < 2; ++j) x[j] += h / 6 * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]);
    }
    const auto response = BendingResponse(kFlex, frequency_hz);
    EXPECT_NEAR(x[0], std::real(response * std::polar(1.0, w * t)), 1e-5 * std::abs(response))
        << frequency_hz << " Hz";
  }
}

TEST(BentTip, ForwardBendingTurnsCamerasTowardsEachOther) {
  const TipMotion left = BentTip(1e-4, 0, 0.203, -1), right = BentTip(1e-4, 0, 0.203, +1);
  EXPECT_EQ(left.turn_rad, -right.turn_rad);
  // A turn about +y (down) looks to the right. 1.5 · 0.1 mm / 203 mm = 0.739 mrad.
  EXPECT_NEAR(left.turn_rad.y(), 0.739e-3, 1e-6);
  EXPECT_EQ(left.turn_rad.x(), 0);
  EXPECT_EQ(left.turn_rad.z(), 0);
  EXPECT_EQ(left.shift_m, Eigen::Vector3d(0, 0, 1e-4));
  EXPECT_EQ(right.shift_m, left.shift_m);
}

// The slope at the tip must fit the deflection: the bar's end moves where its tangent points.
TEST(BentTip, TurnIsTheSlopeOfTheBar) {
  const TipMotion right = BentTip(2e-4, -3e-4, 0.203, +1);
  // Tangent of the bar's right end: x axis turned by the small rotation vector.
  const Eigen::Vector3d tangent =
      Eigen::Vector3d::UnitX() + right.turn_rad.cross(Eigen::Vector3d::UnitX());
  EXPECT_NEAR(tangent.z(), 1.5 * 2e-4 / 0.203, 1e-12);    // forward
  EXPECT_NEAR(-tangent.y(), 1.5 * -3e-4 / 0.203, 1e-12);  // up
}

}  // namespace
}  // namespace windhover
