#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/image/frame_encoding.h"
#include "render/emva_sensor.h"
#include "render/transfer_function.h"
#include "scenarios/sensor_config.h"

namespace windhover {

/// Which image's noise: no two images of a run share any.
struct NoiseKey {
  std::uint64_t seed;
  int aircraft_id;
  int eye;  ///< 0 left, 1 right.
  int tick;
};

/// How `config`'s cameras hand their frames over.
FrameFormat FrameFormatOf(const SensorConfig& config);

/// How one image is taken.
struct Shot {
  NoiseKey key;
  double exposure_s;
  double brightness = 1;  ///< Light collected, relative to an exposure of nominal duration.
  double gain = 1;        ///< Amplification of what was collected.
};

/// From light to bytes: noise in linear light, then the transfer curve.
///
/// Model fast: white is a full well of N electrons; e electrons have a variance of e + read²,
/// drawn from a sum of eight uniform bytes (render/pixel_noise.h). Source: EMVA Standard 1288
/// release 4.0, linear camera model, of which EmvaSensor has all. Noise is a function of key, row
/// and column alone.
class Sensor {
 public:
  explicit Sensor(const SensorConfig& config);

  /// Turns `count` values of light of row `row` (red, green, blue in turn) into what the sensor
  /// makes of it, in place, within 0 to 65535 (white). Without colours a pixel's three values are
  /// three draws of the same light.
  void Expose(const Shot& shot, int row, int count, std::uint16_t* linear) const;

  /// Bytes of `count` values by the transfer curve.
  void Transfer(const std::uint16_t* linear, int count, std::uint8_t* bytes) const {
    transfer_.Apply(linear, count, bytes);
  }

  /// Mean linear light of bytes, 1 is white: what an automatic exposure goes by.
  double MeanLight(const RgbImage& image) const;

 private:
  SensorModel model_;
  bool is_grey_;
  EmvaSensor emva_;
  bool noise_;
  float variance_per_light_;  ///< Shot noise: variance per unit of light, both of 1/65535.
  float read_variance_;
  TransferFunction transfer_;
  std::array<std::uint32_t, 256> light_of_byte_;  ///< 65535 is white.
};

}  // namespace windhover
