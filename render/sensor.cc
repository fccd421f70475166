#include "render/sensor.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/random/random_stream.h"
#include "render/pixel_noise.h"

namespace windhover {
namespace {

constexpr float kWhite = 65535;

// Every value becomes the luminance of its pixel (Rec. ITU-R BT.709), in 65536ths.
void MakeGrey(int count, std::uint16_t* linear) {
  for (int i = 0; i + 2 < count; i += 3) {
    const std::uint32_t luminance =
        (13933u * linear[i] + 46871u * linear[i + 1] + 4732u * linear[i + 2] + 32768u) >> 16;
    std::fill_n(linear + i, 3, static_cast<std::uint16_t>(luminance));
  }
}

// White is as bright as it gets.
__attribute__((target_clones("default", "avx2", "arch=x86-64-v4"))) void Scale(
    float factor, int count, std::uint16_t* linear) {
  for (int i = 0; i < count; ++i) {
    const float light = static_cast<float>(static_cast<std::int32_t>(linear[i])) * factor + 0.5f;
    linear[i] =
        static_cast<std::uint16_t>(static_cast<std::int32_t>(light < kWhite ? light : kWhite));
  }
}

// Differs between cameras, and between images of a camera where `tick` does.
std::uint64_t RowKey(std::string_view name, const NoiseKey& key, int tick, int row) {
  RandomStream stream(key.seed, name);
  stream.Seek((static_cast<std::uint64_t>(static_cast<std::uint32_t>(tick)) << 32) ^
              (static_cast<std::uint64_t>(key.aircraft_id) << 18) ^
              (static_cast<std::uint64_t>(key.eye) << 17) ^ static_cast<std::uint64_t>(row));
  return stream();
}

}  // namespace

FrameFormat FrameFormatOf(const SensorConfig& config) {
  return {.is_bayer = config.bayer == BayerPattern::kRggb,
          .is_grey = config.grey,
          .jpeg_quality = config.jpeg_quality};
}

Sensor::Sensor(const SensorConfig& config)
    : model_(config.model),
      is_grey_(config.grey),
      emva_(config),
      noise_(config.noise),
      variance_per_light_(static_cast<float>(kWhite / config.full_well_e)),
      read_variance_(
          static_cast<float>(std::pow(kWhite / config.full_well_e * config.read_noise_e, 2))),
      transfer_(config.transfer) {
  for (std::size_t i = 0; i < light_of_byte_.size(); ++i) {
    const double light = LightOf(config.transfer, static_cast<double>(i) / 255);
    light_of_byte_[i] = static_cast<std::uint32_t>(std::lround(light * kWhite));
  }
}

void Sensor::Expose(const Shot& shot, int row, int count, std::uint16_t* linear) const {
  if (is_grey_) MakeGrey(count, linear);
  if (shot.brightness != 1) Scale(static_cast<float>(shot.brightness), count, linear);
  if (model_ == SensorModel::kEmva1288) {
    const SensorRowKeys keys{.frame = RowKey("render/sensor", shot.key, shot.key.tick, row),
                             .pattern = RowKey("render/sensor/pattern", shot.key, 0, row)};
    emva_.Expose(keys, shot.exposure_s, shot.gain, count, linear);
    return;
  }
  const auto gain = static_cast<float>(shot.gain);
  if (gain != 1) Scale(gain, count, linear);
  if (!noise_) return;
  AddNoise(RowKey("render/sensor", shot.key, shot.key.tick, row),
           {variance_per_light_ * gain, read_variance_ * gain * gain}, count, linear);
}

double Sensor::MeanLight(const RgbImage& image) const {
  constexpr std::size_t kStep = 7;  // Every seventh byte, of all three colours in turn.
  std::uint64_t sum = 0, n = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += kStep, ++n) {
    sum += light_of_byte_[image.pixels[i]];
  }
  return n == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(n) / kWhite;
}

}  // namespace windhover
