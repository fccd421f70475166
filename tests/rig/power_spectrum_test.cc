#include "rig/power_spectrum.h"

#include <cmath>
#include <complex>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include "common/config/fields.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

constexpr double kRate_hz = 2048, kLength_s = 64;
constexpr int kSamples = 131072;

// Samples of a signal, in g.
std::vector<double> Sampled_g(const Sinusoids& signal) {
  std::vector<double> samples(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    samples[i] = Value(signal, i / kRate_hz) / kStandardGravity_mps2;
  }
  return samples;
}

double Correlation(const Sinusoids& a, const Sinusoids& b) {
  double ab = 0, aa = 0, bb = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = Value(a, i / 1009.0), y = Value(b, i / 1009.0);
    ab += x * y;
    aa += x * x;
    bb += y * y;
  }
  return ab / std::sqrt(aa * bb);
}

// V1.7: MIL-STD-810H, method 514.8, category 24: published as 7.7 g rms.
TEST(PowerSpectrum, AreaOfTheMinimumIntegrityTest) {
  const PowerSpectrum spectrum = PowerSpectrum::MilStd810hCategory24();
  // 0.04 · 980 + ∫ 0.04 (1000/f)² df = 39.2 + 20 = 59.2 g².
  EXPECT_NEAR(spectrum.Power_g2(0, 1e9), 59.2, 1e-9);
  EXPECT_NEAR(std::sqrt(spectrum.Power_g2(0, 1e9)), 7.694, 1e-3);
}

TEST(PowerSpectrum, AreaMatchesQuadratureForEverySlope) {
  for (const double n : {-3.0, -1.0, -0.999999, 0.0, 2.0}) {
    const PowerSpectrum spectrum({{5, 1e-3}, {80, 1e-3 * std::pow(16.0, n)}});
    double sum = 0;
    const int steps = 200000;
    for (int i = 0; i < steps; ++i) {
      const double f = 7 + (i + 0.5) * (60.0 - 7) / steps;
      sum += 1e-3 * std::pow(f / 5, n) * (60.0 - 7) / steps;
    }
    EXPECT_NEAR(spectrum.Power_g2(7, 60) / sum, 1, 1e-8) << n;
  }
}

TEST(PowerSpectrum, FloorHasItsPublishedRms) {
  EXPECT_NEAR(std::sqrt(PowerSpectrum::SmallMultirotorFloor().Power_g2(0, 1e9)), 0.777, 5e-4);
}

// V1.1 (rms within 1 %) and V1.2 (bands within 10 %): line powers are exact, so Rms() is too; a
// record of 64 s adds what neighbouring lines (0.15 Hz apart and more) do not average out: under 1
// %.
TEST(PowerSpectrum, SynthesisHasTheSpectrumsPower) {
  const PowerSpectrum spectrum = PowerSpectrum::SmallMultirotorFloor();
  const Sinusoids signal = spectrum.Synthesize(0, 512, RandomStream(1, "axis"));
  const double expected_g = std::sqrt(spectrum.Power_g2(0, 1e9));
  EXPECT_NEAR(Rms(signal) / kStandardGravity_mps2 / expected_g, 1, 1e-12);

  const std::vector<double> samples = Sampled_g(signal);
  double sum = 0;
  for (const double sample : samples) sum += sample * sample;
  EXPECT_NEAR(std::sqrt(sum / kSamples) / expected_g, 1, 0.01);

  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> bins;
  fft.fwd(bins, samples);
  for (double low_hz = 16; low_hz < 400; low_hz *= 2) {
    double power_g2 = 0;
    for (int k = static_cast<int>(low_hz * kLength_s); k < 2 * low_hz * kLength_s; ++k) {
      power_g2 += 2 * std::norm(bins[k] / static_cast<double>(kSamples));
    }
    EXPECT_NEAR(power_g2 / spectrum.Power_g2(low_hz, 2 * low_hz), 1, 0.1) << low_hz << " Hz";
  }
}

TEST(PowerSpectrum, LeavesOutWhatIsSlower) {
  for (const Sinusoid& line :
       PowerSpectrum::SmallMultirotorFloor().Synthesize(25, 64, RandomStream(1, "axis"))) {
    EXPECT_GE(line.frequency_hz, 25);
  }
  EXPECT_TRUE(
      PowerSpectrum::SmallMultirotorFloor().Synthesize(501, 64, RandomStream(1, "axis")).empty());
}

// V1.3: two independent sums of 512 lines correlate by about 1 / √(lines that matter) = 0.05.
TEST(PowerSpectrum, OtherSeedsAndNamesAreIndependent) {
  const PowerSpectrum spectrum = PowerSpectrum::SmallMultirotorFloor();
  const Sinusoids one = spectrum.Synthesize(0, 512, RandomStream(1, "a"));
  EXPECT_LT(std::abs(Correlation(one, spectrum.Synthesize(0, 512, RandomStream(2, "a")))), 0.1);
  EXPECT_LT(std::abs(Correlation(one, spectrum.Synthesize(0, 512, RandomStream(1, "b")))), 0.1);
  EXPECT_NEAR(Correlation(one, spectrum.Synthesize(0, 512, RandomStream(1, "a"))), 1, 1e-12);
}

TEST(PowerSpectrum, ReadsAFile) {
  const auto spectrum =
      PowerSpectrum::FromFile(test::ScratchFile("f_hz,g2_per_hz\n20,0.04\n1000,0.04\n2000,0.01\n"));
  EXPECT_NEAR(spectrum.Power_g2(0, 1e9), 59.2, 1e-9);
}

std::string ErrorOf(const std::string& content) {
  const std::string file = test::ScratchFile(content);
  try {
    PowerSpectrum::FromFile(file);
  } catch (const ConfigError& e) {
    return std::regex_replace(e.what(), std::regex(file), "F");
  }
  return "";
}

TEST(PowerSpectrum, ReportsEveryBadLineOfAFile) {
  EXPECT_EQ(ErrorOf("f_hz,g2_per_hz\n20,0.04\n20,0.04\n-1,1\n30,0\n40,nan\n50\n"),
            "F:6: column 2: must be a finite number (found 'nan')\n"
            "F:7: must have 2 columns (found 1)\n"
            "F:3: f_hz: must rise from line to line (found 20 after 20)\n"
            "F:4: f_hz: must be > 0 (found -1)\n"
            "F:5: g2_per_hz: must be > 0 (found 0)");
  EXPECT_EQ(ErrorOf("20,0.04\n"), "F: must have at least 2 lines of f_hz,g2_per_hz (found 1)");
  EXPECT_EQ(ErrorOf(""), "F: must have at least 2 lines of f_hz,g2_per_hz (found 0)");
}

}  // namespace
}  // namespace windhover
