#include "render/emva_sensor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace windhover {
namespace {

constexpr int kCount = 3840, kRows = 200;
constexpr double kPixels = static_cast<double>(kCount) * kRows;
constexpr double kExposure_s = 0.01;

// 0.4 grey values an electron, so that the converter's steps are finer than the read noise.
SensorConfig Config() {
  SensorConfig config;
  config.model = SensorModel::kEmva1288;
  config.emva.gain_dn_per_e = 0.4;
  config.emva.dark_current_e_per_s = 0;
  return config;
}

// Grey values of a camera that sees the same light everywhere.
std::vector<double> Frame(const SensorConfig& config, double light, std::uint64_t frame,
                          std::uint64_t camera = 1, double exposure_s = kExposure_s) {
  const EmvaSensor sensor(config);
  std::vector<double> grey;
  for (std::uint64_t row = 0; row < kRows; ++row) {
    std::vector<std::uint16_t> values(kCount, static_cast<std::uint16_t>(std::lround(light)));
    const SensorRowKeys keys{.frame = (frame * 7919 + camera * 1299709 + row) * 0x9e3779b97f4a7c15u,
                             .pattern = (camera * 104729 + row) * 0xd1b54a32d192ed03u};
    sensor.Expose(keys, exposure_s, 1, kCount, values.data());
    for (const std::uint16_t value : values) {
      grey.push_back(std::round(value * sensor.LargestDn() / 65535));
    }
  }
  return grey;
}

double Mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return sum / static_cast<double>(v.size());
}

double Covariance(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = Mean(a), mean_b = Mean(b);
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - mean_a) * (b[i] - mean_b);
  return sum / static_cast<double>(a.size());
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b) {
  return Covariance(a, b) / std::sqrt(Covariance(a, a) * Covariance(b, b));
}

// Mean, and variance in time: half of that of the difference of two frames, which takes the fixed
// pattern away (EMVA 1288, section 6.6).
struct Transfer {
  double mean, variance;
};
Transfer TransferAt(const SensorConfig& config, double electrons) {
  const double light = electrons / config.full_well_e * 65535;
  const std::vector<double> a = Frame(config, light, 1), b = Frame(config, light, 2);
  std::vector<double> difference(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) difference[i] = a[i] - b[i];
  return {(Mean(a) + Mean(b)) / 2, Covariance(difference, difference) / 2};
}

// V3.8: photon transfer. 768,000 pixels know a variance to 0.16 %.
TEST(EmvaSensor, TransfersPhotons) {
  const SensorConfig config = Config();
  const double gain = config.emva.gain_dn_per_e;
  const Transfer dark = TransferAt(config, 0);
  EXPECT_NEAR(dark.mean, config.emva.offset_dn, 0.02);
  const double dark_variance = gain * gain * config.read_noise_e * config.read_noise_e + 1 / 12.0;
  EXPECT_NEAR(dark.variance / dark_variance, 1, 0.03);
  for (const double electrons : {5.0, 20.0, 40.0, 200.0, 1000.0, 5000.0, 9000.0}) {
    const Transfer bright = TransferAt(config, electrons);
    // The light's own step is 0.15 electrons; five standard deviations of the mean.
    EXPECT_NEAR(bright.mean - dark.mean, gain * electrons, gain * 0.1 + 0.02) << electrons;
    const double slope = (bright.variance - dark.variance) / (bright.mean - dark.mean);
    // Below 200 electrons read noise hides the slope: 0.23 % of 64 over 20 electrons is 0.7 %.
    EXPECT_NEAR(slope / gain, 1, electrons < 20 ? 0.06 : 0.02) << electrons;
  }
}

// V3.8: beyond a full well no electron is kept; the read noise remains.
TEST(EmvaSensor, SaturatesAtTheFullWell) {
  SensorConfig config = Config();
  config.emva.bits = 13;
  config.emva.photons_at_white = 25000;  // 15000 electrons in a well of 10000.
  const std::vector<double> full = Frame(config, 65535, 1);
  EXPECT_NEAR(Mean(full), 0.4 * 10000 + 16, 0.05);
  EXPECT_NEAR(std::sqrt(Covariance(full, full)), 0.4 * std::hypot(8, 2), 0.03);
  const std::vector<double> half = Frame(config, 32768, 1);
  EXPECT_NEAR(Mean(half), 0.4 * 7500 + 16, 0.2);
}

// Signal to noise in time is √electrons where nothing else matters.
TEST(EmvaSensor, SignalToNoiseIsRootOfElectrons) {
  const SensorConfig config = Config();
  const Transfer at = TransferAt(config, 9000);
  const double snr = (at.mean - 16) / std::sqrt(at.variance);
  EXPECT_NEAR(snr / std::sqrt(9000.0), 1, 0.01);
}

// V3.9: the pattern of a camera is the same in all its frames, that of another camera is another.
TEST(EmvaSensor, PatternIsFixed) {
  SensorConfig config = Config();
  config.emva.prnu = 0.05;
  config.emva.dsnu_e = 20;
  config.emva.offset_dn = 100;  // So that no pixel is black.
  for (const double electrons : {0.0, 5000.0}) {
    const double light = electrons / config.full_well_e * 65535;
    const std::vector<double> a = Frame(config, light, 1), b = Frame(config, light, 2);
    const std::vector<double> other = Frame(config, light, 3, 2);
    const double pattern_e = std::hypot(0.05 * electrons, 20);
    EXPECT_NEAR(std::sqrt(Covariance(a, b)) / (0.4 * pattern_e), 1, 0.02);
    EXPECT_LT(std::abs(Correlation(a, other)), 0.01);
  }
}

// V3.13
TEST(EmvaSensor, NoiseOfCamerasAndFramesIsIndependent) {
  SensorConfig config = Config();
  config.emva.prnu = config.emva.dsnu_e = 0;
  for (const double light : {0.0, 30000.0}) {
    const std::vector<double> noise = Frame(config, light, 1);
    EXPECT_LT(std::abs(Correlation(noise, Frame(config, light, 1, 2))), 0.01);
    EXPECT_LT(std::abs(Correlation(noise, Frame(config, light, 2))), 0.01);
    EXPECT_EQ(noise, Frame(config, light, 1));
  }
}

// 100 electrons a second at 25 °C are 400 at 41 °C: 4 in 10 ms, with as much variance.
TEST(EmvaSensor, DarkCurrentDoublesWithTemperature) {
  SensorConfig config = Config();
  config.emva.dark_current_e_per_s = 100;
  config.emva.dsnu_e = 0;
  config.read_noise_e = 1;
  config.emva.gain_dn_per_e = 4;
  config.emva.temperature_C = 41;
  EXPECT_NEAR(EmvaSensor(config).DarkElectrons(0.01), 4, 1e-12);
  const Transfer warm = TransferAt(config, 0);
  EXPECT_NEAR((warm.mean - 16) / 4, 4, 0.02);
  EXPECT_NEAR(warm.variance / (16 * (4 + 1) + 1 / 12.0), 1, 0.02);
}

TEST(EmvaSensor, QuantisesToItsBits) {
  SensorConfig config = Config();
  config.noise = false;
  config.emva.bits = 8;
  config.emva.gain_dn_per_e = 0;
  config.emva.offset_dn = 0;
  const EmvaSensor sensor(config);
  EXPECT_DOUBLE_EQ(sensor.GainDnPerE(), 0.0255);
  for (int value = 0; value < 65536; value += 13) {
    auto light = static_cast<std::uint16_t>(value);
    sensor.Expose({}, kExposure_s, 1, 1, &light);
    EXPECT_EQ(light % 257, 0) << value;
    EXPECT_NEAR(light, value, 129) << value;
  }
}

}  // namespace
}  // namespace windhover
