#include "rig/sinusoids.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace windhover {
namespace {

const Sinusoids kSignal = {{12, 0.7, 0.3}, {45.5, 0.2, 2.0}, {117, 0.05, -1.1}};

TEST(Sinusoids, WorkedExample) {
  // 3 cos(2π · 0.25) + ... of a 1 Hz cosine: 3 at 0, 0 a quarter period later.
  const Sinusoids signal = {{1, 3, 0}};
  EXPECT_EQ(Value(signal, 0), 3);
  EXPECT_NEAR(Value(signal, 0.25), 0, 1e-15);
  EXPECT_DOUBLE_EQ(Rms(signal), 3 / std::numbers::sqrt2);
}

TEST(Sinusoids, DerivativeMatchesNumericDerivative) {
  const Sinusoids derivative = Filtered(kSignal, Differentiation);
  for (double t_s = -1; t_s < 100; t_s += 3.7) {
    const double h = 1e-6, numeric = (Value(kSignal, t_s + h) - Value(kSignal, t_s - h)) / (2 * h);
    // h² / 6 · f''' is 4e-6 of the 117 Hz line; rounding of f / h is 1e-9.
    EXPECT_NEAR(Value(derivative, t_s), numeric, 2e-4);
  }
}

TEST(Sinusoids, IntegrationUndoesDifferentiation) {
  const Sinusoids same = Filtered(Filtered(kSignal, Differentiation), Integration);
  for (double t_s = 0; t_s < 10; t_s += 0.37) {
    EXPECT_NEAR(Value(same, t_s), Value(kSignal, t_s), 1e-12);
  }
}

// V1.6: the mean over an exposure against a midpoint rule with 1000 points, whose error is
// (2π f T / 1000)² / 24 of the amplitude: 7e-7 for 117 Hz and 10 ms.
TEST(Sinusoids, ExposureMeanMatchesQuadrature) {
  for (const double duration_s : {0.0, 0.002, 0.01}) {
    const Sinusoids mean = Filtered(kSignal, MeanOver(duration_s));
    for (const double t_s : {0.0, 0.123, 57.1}) {
      double sum = 0;
      for (int i = 0; i < 1000; ++i) sum += Value(kSignal, t_s + (i + 0.5) / 1000 * duration_s);
      EXPECT_NEAR(Value(mean, t_s), sum / 1000, 1e-6);
    }
  }
}

TEST(Sinusoids, ExposureOfOnePeriodAveragesToNothing) {
  EXPECT_NEAR(Value(Filtered({{100, 1, 0.4}}, MeanOver(0.01)), 0.3), 0, 1e-14);
}

}  // namespace
}  // namespace windhover
