#include "rig/sinusoids.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "rig/sinusoid_sums.h"

namespace windhover {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
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

// Lines of random frequencies up to `max_hz`.
Sinusoids RandomLines(int n, double max_hz, RandomStream* stream) {
  Sinusoids signal;
  for (int i = 0; i < n; ++i) {
    const double frequency_hz = stream->Uniform(10, max_hz);
    signal.push_back({frequency_hz, stream->Uniform(0.1, 1), stream->Uniform(0, kTwoPi)});
  }
  return signal;
}

// As the Fourier series of `n` samples at `rate_hz`, without its `first - 1` slowest lines.
Sinusoids HarmonicLines(int n, double rate_hz, int first, RandomStream* stream) {
  Sinusoids signal;
  for (int k = first; 2 * k < n; ++k) {
    signal.push_back({k * rate_hz / n, stream->Uniform(0.1, 1), stream->Uniform(0, kTwoPi)});
  }
  return signal;
}

Sinusoids WithOtherPhases(Sinusoids signal, double by_rad) {
  for (Sinusoid& line : signal) line.phase_rad += by_rad;
  return signal;
}

// Alone and shared, few and more than one block of 512, none; series with as few table entries
// for the highest line as there can be (511 of 2048), and more sums than one table takes.
std::vector<Sinusoids> AllKindsOfSums(double max_hz) {
  RandomStream stream(1, "lines");
  std::vector<Sinusoids> sums = {RandomLines(5, max_hz, &stream),
                                 RandomLines(21, max_hz, &stream),
                                 RandomLines(1200, max_hz, &stream),
                                 {}};
  sums.push_back(WithOtherPhases(sums[1], 0.4));
  sums.push_back(WithOtherPhases(sums[2], 1.9));
  sums.push_back({{max_hz, 1, 0.3}});
  sums.push_back(HarmonicLines(1023, 200, 49, &stream));
  sums.push_back(HarmonicLines(12000, 200, 600, &stream));
  for (int i = 0; i < 9; ++i) sums.push_back(WithOtherPhases(sums[7], 0.7 * i));
  return sums;
}

// Near and far, before and after 0, at anchors, between them and a hair beside, unevenly.
std::vector<double> AllKindsOfTimes(double max_hz) {
  std::vector<double> times_s = {0, 1e-12, -1e-12, 5.115, 60, -60, 12345.678, -98765.4};
  const double spacing_s = 3.4 / (std::numbers::pi * max_hz);
  for (const double anchor : {0.0, 1.0, -7.0, 54321.0}) {
    for (const double part : {-0.5, -0.4999999, -0.3, 0.0, 0.1, 0.4999999, 0.5}) {
      times_s.push_back((anchor + part) * spacing_s);
    }
  }
  for (int i = 0; i < 40; ++i) times_s.push_back(0.0013 * ((i * 23) % 40 - 5) + (i % 3) * 17.1);
  return times_s;
}

// Against the plain sum. The series' and windows' first terms left out and the sine's rounding are
// below 1e-13 of the amplitudes; 2π f t is held to 4 roundings by both sides, and a frequency is
// that of its harmonic to 1e-15.
TEST(SinusoidSums, AreTheSumsOfTheirSinusoids) {
  for (const double max_hz : {117.0, 500.0, 2000.0}) {
    const std::vector<Sinusoids> signals = AllKindsOfSums(max_hz);
    const SinusoidSums sums(signals);
    std::vector<double> values(signals.size());
    std::vector<double> alone(signals.size());
    for (const double t_s : AllKindsOfTimes(max_hz)) {
      sums.At(t_s, values.data());
      sums.AtAlone(t_s, alone.data());
      for (std::size_t k = 0; k < signals.size(); ++k) {
        double bound = 1e-15;
        for (const Sinusoid& line : signals[k]) {
          bound += line.amplitude * (1e-13 + 2e-15 * kTwoPi * line.frequency_hz * std::abs(t_s));
        }
        EXPECT_NEAR(values[k], Value(signals[k], t_s), bound) << k << " at " << t_s;
        EXPECT_NEAR(alone[k], Value(signals[k], t_s), bound) << k << " at " << t_s;
      }
    }
  }
}

TEST(SinusoidSums, AreTheSameBitsInAnyCompanyOnEveryProcessor) {
  const std::vector<Sinusoids> signals = AllKindsOfSums(500);
  const SinusoidSums sums(signals), again(signals);
  const std::vector<double> times_s = AllKindsOfTimes(500);
  const std::vector<double> many = sums.AtMany(times_s);
  EXPECT_EQ(many, again.AtMany(times_s));
  EXPECT_EQ(many, sums.AtMany(times_s, InstructionSet::kSse2));
  if (WidestInstructionSet() != InstructionSet::kSse2) {
    EXPECT_EQ(many, sums.AtMany(times_s, InstructionSet::kAvx2));
  }
  std::vector<double> one(signals.size());
  for (std::size_t i = times_s.size(); i-- > 0;) {
    sums.At(times_s[i], one.data());
    const auto row = many.begin() + static_cast<std::ptrdiff_t>(i * signals.size());
    EXPECT_TRUE(std::equal(one.begin(), one.end(), row)) << times_s[i];
    std::vector<double> alone(signals.size()), other(signals.size());
    sums.AtAlone(times_s[i], alone.data());
    sums.AtAlone(times_s[i], other.data(), InstructionSet::kSse2);
    EXPECT_EQ(alone, other) << times_s[i];
    if (WidestInstructionSet() == InstructionSet::kSse2) continue;
    sums.AtAlone(times_s[i], other.data(), InstructionSet::kAvx2);
    EXPECT_EQ(alone, other) << times_s[i];
  }
}

TEST(HarmonicsOf, KnowsAFourierSeriesFromOtherLines) {
  RandomStream stream(1, "lines");
  Sinusoids signal = HarmonicLines(12000, 200, 600, &stream);
  const auto harmonics = HarmonicsOf(signal);
  ASSERT_TRUE(harmonics);
  EXPECT_EQ(harmonics->first, 600u);
  EXPECT_DOUBLE_EQ(harmonics->fundamental_hz, 1.0 / 60);
  signal[1000].frequency_hz *= 1 + 1e-12;
  EXPECT_FALSE(HarmonicsOf(signal));
  EXPECT_FALSE(HarmonicsOf(RandomLines(500, 500, &stream)));
  EXPECT_FALSE(HarmonicsOf(Sinusoids(500, {50, 1, 0})));
  EXPECT_FALSE(HarmonicsOf({}));
  // The largest table, and a line too many for it.
  constexpr int kMost = 1 << 18;
  EXPECT_TRUE(HarmonicsOf(HarmonicLines(2 * kMost, 200, kMost - 300, &stream)));
  EXPECT_FALSE(HarmonicsOf(HarmonicLines(2 * kMost + 2, 200, kMost - 300, &stream)));
  // Evenly spaced, but not multiples of one frequency.
  for (std::size_t i = 0; i < signal.size(); ++i) {
    signal[i].frequency_hz = 10.37 + 0.1 * static_cast<double>(i);
  }
  EXPECT_FALSE(HarmonicsOf(signal));
}

}  // namespace
}  // namespace windhover
