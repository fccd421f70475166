#include "render/emva_sensor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/random/random_stream.h"
#include "render/pixel_noise.h"

namespace windhover {
namespace {

constexpr float kLargestPoissonMean = 32;

// A hash of 32 bits. Source: C. Wellons, "Prospecting for Hash Functions", 2018 (lowbias32).
std::uint32_t Hash32(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}

std::uint64_t KeyOf(std::uint64_t key, std::uint64_t purpose) {
  RandomStream stream(key, "emva");
  stream.Seek(purpose);
  return stream();
}

// e^-x for x in [0, 32], by Taylor's series at x / 64 and six squarings: 1e-6 relative.
double ExpOfMinus(double x) {
  const double t = -x / 64;
  double value = 1;
  for (int n = 9; n > 0; --n) value = 1 + value * t / n;
  for (int i = 0; i < 6; ++i) value *= value;
  return value;
}

// Inversion of the distribution function at a uniform number.
float Poisson(float mean, std::uint32_t bits) {
  const double uniform = (bits + 0.5) / 4294967296.0;
  double probability = ExpOfMinus(mean), below = probability;
  int n = 0;
  while (below < uniform && n < 200) {
    probability *= mean / ++n;
    below += probability;
  }
  return static_cast<float>(n);
}

struct Readout {
  float full_well_e, dn_per_e, offset_dn, largest_dn, values_per_dn;
};

// `electrons` collected, `dark_e` read with them.
__attribute__((target_clones("default", "avx2"))) void ReadOut(const Readout& readout,
                                                               const float* electrons,
                                                               const float* dark_e, int count,
                                                               std::uint16_t* values) {
  const Readout r = readout;
  for (int i = 0; i < count; ++i) {
    const float collected = electrons[i] < r.full_well_e ? electrons[i] : r.full_well_e;
    float dn = r.dn_per_e * (collected + dark_e[i]) + r.offset_dn;
    dn = dn > 0 ? dn : 0;
    dn = dn < r.largest_dn ? dn : r.largest_dn;
    const auto rounded = static_cast<std::int32_t>(dn + 0.5f);
    values[i] = static_cast<std::uint16_t>(
        static_cast<std::int32_t>(static_cast<float>(rounded) * r.values_per_dn + 0.5f));
  }
}

}  // namespace

EmvaSensor::EmvaSensor(const SensorConfig& config)
    : noise_(config.noise),
      full_well_e_(static_cast<float>(config.full_well_e)),
      read_noise_e_(static_cast<float>(config.read_noise_e)),
      prnu_(static_cast<float>(config.emva.prnu)),
      dsnu_e_(static_cast<float>(config.emva.dsnu_e)) {
  const EmvaConfig& emva = config.emva;
  const double electrons_at_white = emva.photons_at_white > 0
                                        ? emva.photons_at_white * emva.quantum_efficiency
                                        : config.full_well_e;
  electrons_per_light_ = static_cast<float>(electrons_at_white / 65535);
  dark_current_e_per_s_ =
      emva.dark_current_e_per_s * std::exp2((emva.temperature_C - 25) / emva.doubling_K);
  largest_dn_ = std::exp2(emva.bits) - 1;
  offset_dn_ = emva.offset_dn;
  gain_dn_per_e_ =
      emva.gain_dn_per_e > 0 ? emva.gain_dn_per_e : (largest_dn_ - offset_dn_) / config.full_well_e;
}

void EmvaSensor::Expose(const SensorRowKeys& keys, double exposure_s, double gain, int count,
                        std::uint16_t* values) const {
  const auto size = static_cast<std::size_t>(count);
  std::vector<float> electrons(size), dark_e(size, 0.0f);
  const auto dark_current_e = static_cast<float>(DarkElectrons(exposure_s));
  for (std::size_t i = 0; i < size; ++i) {
    electrons[i] = static_cast<float>(values[i]) * electrons_per_light_ + dark_current_e;
  }
  if (noise_) {
    std::vector<float> normal(size);
    const auto fill = [&](std::uint64_t key, std::uint64_t purpose) {
      FillNoise(KeyOf(key, purpose), count, normal.data());
    };
    fill(keys.pattern, 0);
    for (std::size_t i = 0; i < size; ++i) {
      electrons[i] += (electrons[i] - dark_current_e) * (prnu_ * normal[i]);
    }
    fill(keys.frame, 1);
    const auto poisson_key = static_cast<std::uint32_t>(KeyOf(keys.frame, 2));
    for (std::size_t i = 0; i < size; ++i) {
      const float mean = electrons[i];
      electrons[i] =
          mean < kLargestPoissonMean
              ? Poisson(mean, Hash32(poisson_key ^ Hash32(static_cast<std::uint32_t>(i))))
              : mean + std::sqrt(mean) * normal[i];
    }
    fill(keys.pattern, 3);
    for (std::size_t i = 0; i < size; ++i) dark_e[i] = dsnu_e_ * normal[i];
    fill(keys.frame, 4);
    for (std::size_t i = 0; i < size; ++i) dark_e[i] += read_noise_e_ * normal[i];
  }
  ReadOut({full_well_e_, static_cast<float>(gain_dn_per_e_ * gain), static_cast<float>(offset_dn_),
           static_cast<float>(largest_dn_), static_cast<float>(65535 / largest_dn_)},
          electrons.data(), dark_e.data(), count, values);
}

}  // namespace windhover
