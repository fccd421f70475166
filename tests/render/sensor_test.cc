#include "render/sensor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/image/srgb.h"
#include "render/pixel_noise.h"

namespace windhover {
namespace {

constexpr int kCount = 3840, kRows = 200;

struct Moments {
  double mean = 0, variance = 0;
};

Moments MomentsAt(const Sensor& sensor, std::uint16_t light) {
  double sum = 0, squares = 0;
  for (int row = 0; row < kRows; ++row) {
    std::vector<std::uint16_t> values(kCount, light);
    sensor.Expose({{.seed = 3, .aircraft_id = 0, .eye = 0, .tick = 5}, 0.002}, row, kCount,
                  values.data());
    for (const std::uint16_t value : values) {
      sum += value;
      squares += static_cast<double>(value) * value;
    }
  }
  const double n = static_cast<double>(kCount) * kRows;
  return {sum / n, squares / n - sum * sum / (n * n)};
}

// V3.8: photon transfer (EMVA 1288, section 6): variance over mean is one electron, and at dark it
// is the read noise. 768,000 draws know a variance to sqrt(2 / n) = 0.16 %.
TEST(Sensor, TransfersPhotons) {
  const SensorConfig config{.noise = true, .full_well_e = 10000, .read_noise_e = 8};
  const Sensor sensor(config);
  const double light_per_e = 65535 / config.full_well_e;
  for (const double electrons : {200.0, 1000.0, 5000.0, 9000.0}) {
    const auto light = static_cast<std::uint16_t>(std::lround(electrons * light_per_e));
    const Moments moments = MomentsAt(sensor, light);
    const double exact_variance = (light / light_per_e + 64) * light_per_e * light_per_e;
    EXPECT_NEAR(moments.variance / exact_variance, 1, 0.01) << electrons;
    EXPECT_NEAR(moments.mean, light, 4 * std::sqrt(exact_variance / (kCount * kRows))) << electrons;
  }
}

TEST(Sensor, ClipsAtBlackAndWhite) {
  const Sensor sensor(SensorConfig{.noise = true, .full_well_e = 1000, .read_noise_e = 30});
  std::vector<std::uint16_t> dark(kCount, 0), white(kCount, 65535);
  sensor.Expose({{1, 0, 0, 0}, 0.002}, 0, kCount, dark.data());
  sensor.Expose({{1, 0, 0, 0}, 0.002}, 1, kCount, white.data());
  EXPECT_EQ(*std::min_element(dark.begin(), dark.end()), 0);
  EXPECT_LT(*std::max_element(dark.begin(), dark.end()), 20000);
  EXPECT_EQ(*std::max_element(white.begin(), white.end()), 65535);
}

std::vector<double> NoiseOf(const NoiseKey& key) {
  const Sensor sensor(SensorConfig{});
  std::vector<double> noise;
  for (int row = 0; row < kRows; ++row) {
    std::vector<std::uint16_t> values(kCount, 30000);
    sensor.Expose({key, 0.002}, row, kCount, values.data());
    for (const std::uint16_t value : values) noise.push_back(value - 30000.0);
  }
  return noise;
}

double Correlation(const std::vector<double>& a, const std::vector<double>& b,
                   std::size_t lag = 0) {
  double ab = 0, aa = 0, bb = 0;
  for (std::size_t i = 0; i + lag < a.size(); ++i) {
    ab += a[i] * b[i + lag];
    aa += a[i] * a[i];
    bb += b[i + lag] * b[i + lag];
  }
  return ab / std::sqrt(aa * bb);
}

// V3.13: independent samples correlate by 1 / sqrt(768,000) = 0.0011 rms.
TEST(Sensor, NoiseOfEyesTicksAircraftAndSeedsIsIndependent) {
  const NoiseKey left{.seed = 3, .aircraft_id = 0, .eye = 0, .tick = 7};
  NoiseKey right = left, later = left, other = left, reseeded = left;
  right.eye = 1;
  later.tick = 8;
  other.aircraft_id = 1;
  reseeded.seed = 4;
  const std::vector<double> noise = NoiseOf(left);
  for (const NoiseKey& key : {right, later, other, reseeded}) {
    EXPECT_LT(std::abs(Correlation(noise, NoiseOf(key))), 0.01);
  }
  EXPECT_EQ(noise, NoiseOf(left));
}

TEST(Sensor, NoiseOfNeighboursIsIndependent) {
  const std::vector<double> noise = NoiseOf({3, 0, 0, 7});
  for (const std::size_t lag : {1, 2, 3, 6, kCount}) {
    EXPECT_LT(std::abs(Correlation(noise, noise, lag)), 0.01) << lag;
  }
}

TEST(Sensor, TransfersBySrgb) {
  const Sensor sensor(SensorConfig{});
  for (int byte = 0; byte < 256; ++byte) {
    const auto light =
        static_cast<std::uint16_t>(std::lround(65535 * LinearFromSrgb(byte / 255.0)));
    std::uint8_t out = 0;
    sensor.Transfer(&light, 1, &out);
    EXPECT_NEAR(out, byte, 1) << byte;  // The table's steps of 8 are below half a byte.
  }
}

// Kadlec gives 6.5e-4; a variance is then true to twice that.
TEST(PixelNoise, TakesRoots) {
  for (float v = 1e-3f; v < 1e10f; v *= 1.0137f) {
    EXPECT_NEAR(QuickRoot(v) / std::sqrt(v), 1, 7e-4) << v;
  }
  EXPECT_EQ(QuickRoot(0), 0);
}

// Of n draws of a normal distribution the kurtosis is known to sqrt(24 / n) = 0.004; eight bytes
// have -0.15.
TEST(PixelNoise, IsNearlyNormal) {
  constexpr int kDraws = 1 << 20;
  std::vector<float> values(kDraws);
  FillNoise(11, kDraws, values.data());
  double sum = 0, squares = 0, cubes = 0, fourth = 0;
  for (const double x : values) {
    sum += x;
    squares += x * x;
    cubes += x * x * x;
    fourth += x * x * x * x;
    ASSERT_LT(std::abs(x), 4.9);
  }
  const double n = kDraws;
  EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(2 / n));
  EXPECT_NEAR(cubes / n, 0, 4 * std::sqrt(15 / n));
  EXPECT_NEAR(fourth / squares / squares * n - 3, -0.15, 0.02);
}

// Positions that share their bytes (16 apart) and those that do not: n pairs know a correlation
// to 1 / sqrt(n).
TEST(PixelNoise, DoesNotCorrelateAlongARow) {
  constexpr std::size_t kDraws = 1 << 20;
  std::vector<float> values(kDraws);
  FillNoise(12, static_cast<int>(kDraws), values.data());
  for (std::size_t lag = 1; lag <= 130; ++lag) {
    double product = 0;
    for (std::size_t i = 0; i + lag < kDraws; ++i) {
      product += static_cast<double>(values[i]) * static_cast<double>(values[i + lag]);
    }
    EXPECT_LT(std::abs(product / kDraws), 4.5 / std::sqrt(kDraws)) << lag;
  }
}

// Any length, any light; one value is its own noise whatever comes after it.
TEST(PixelNoise, HasTheSameBitsFromEveryInstructionSet) {
  for (const int count : {1, 15, 16, 17, 63, 64, 65, 130, 3840}) {
    std::vector<std::uint16_t> light;
    for (int i = 0; i < count; ++i) light.push_back(static_cast<std::uint16_t>(2000 + i * 331));
    std::vector<std::uint16_t> narrow = light;
    AddNoise(5, {.per_light = 6.5f, .of_read = 900}, count, narrow.data(), InstructionSet::kSse2);
    EXPECT_NE(narrow, light);
    for (int isa = 1; isa <= static_cast<int>(WidestInstructionSet()); ++isa) {
      std::vector<std::uint16_t> wide = light;
      wide.resize(light.size() + 64, 7);
      AddNoise(5, {.per_light = 6.5f, .of_read = 900}, count, wide.data(),
               static_cast<InstructionSet>(isa));
      EXPECT_EQ(std::vector<std::uint16_t>(wide.begin() + count, wide.end()),
                std::vector<std::uint16_t>(64, 7));
      wide.resize(light.size());
      EXPECT_EQ(wide, narrow) << count << " " << isa;
    }
  }
}

// Every light there is: rounded from at most 0.02 off the curve, the same on every processor.
TEST(TransferFunction, FollowsItsCurve) {
  std::vector<std::uint16_t> lights;
  for (int light = 0; light < 65536; ++light) lights.push_back(static_cast<std::uint16_t>(light));
  std::vector<std::uint8_t> wide(lights.size()), narrow(lights.size());
  for (const TransferCurve curve :
       {TransferCurve::kSrgb, TransferCurve::kGamma22, TransferCurve::kLinear}) {
    const TransferFunction transfer(curve);
    transfer.Apply(lights.data(), 65531, wide.data());  // Not a whole number of sixteens.
    transfer.Apply(lights.data(), 65531, narrow.data(), InstructionSet::kSse2);
    ASSERT_EQ(wide, narrow);
    for (std::size_t i = 8; i < 65531; ++i) {
      const double middle = (static_cast<double>(i / 8) + 0.5) / 8192;
      const double value = curve == TransferCurve::kLinear    ? middle
                           : curve == TransferCurve::kGamma22 ? std::pow(middle, 1 / 2.2)
                                                              : SrgbFromLinear(middle);
      ASSERT_NEAR(narrow[i], 255 * value, 0.52) << i;
    }
    EXPECT_EQ(narrow[0], 0);
  }
}

TEST(Sensor, CanBeClean) {
  const Sensor sensor(SensorConfig{.noise = false});
  std::vector<std::uint16_t> values(100, 1234);
  sensor.Expose({{1, 0, 0, 0}, 0.002}, 0, 100, values.data());
  EXPECT_EQ(values, std::vector<std::uint16_t>(100, 1234));
}

}  // namespace
}  // namespace windhover
