#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// Which image's noise: no two images of a run share any.
struct NoiseKey {
  std::uint64_t seed;
  int aircraft_id;
  int eye;  ///< 0 left, 1 right.
  int tick;
};

/// From light to bytes: shot and read noise in linear light, then the sRGB transfer curve.
///
/// White is a full well of N electrons; e electrons have a variance of e + read², drawn from a
/// sum of eight uniform bytes (kurtosis -0.15, never beyond 4.9 sigma). Source: EMVA Standard 1288
/// release 4.0, linear camera model. Noise is a function of key, row and column alone.
class Sensor {
 public:
  explicit Sensor(const SensorConfig& config);

  /// Adds noise to `count` values of row `row` in place, within 0 to 65535 (white).
  void AddNoise(const NoiseKey& key, int row, int count, std::uint16_t* linear) const;

  /// sRGB bytes of `count` linear values.
  void Transfer(const std::uint16_t* linear, int count, std::uint8_t* srgb) const;

 private:
  bool noise_;
  float variance_per_light_;  ///< Shot noise: variance per unit of light, both of 1/65535.
  float read_variance_;
  std::array<std::uint8_t, 8192> table_;
};

}  // namespace windhover
