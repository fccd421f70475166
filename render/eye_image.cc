#include "render/eye_image.h"

#include <algorithm>

namespace windhover {
namespace {

// Integers only: the same bits from every clone.
__attribute__((target_clones("default", "avx2"))) void AddRow(const std::uint16_t* row,
                                                              std::uint32_t share, int count,
                                                              std::uint32_t* sum) {
  for (int i = 0; i < count; ++i) sum[i] += row[i] * share;
}

// The shares sum to 65536, so that white times them, rounded, still fits in 32 bits.
__attribute__((target_clones("default", "avx2"))) void MeanRow(const std::uint32_t* sum, int count,
                                                               std::uint16_t* row) {
  for (int i = 0; i < count; ++i) row[i] = static_cast<std::uint16_t>((sum[i] + 32768u) >> 16);
}

void BlendRow(const TargetLayer& layer, int y, std::uint16_t* row) {
  const PixelRect& roi = layer.roi;
  if (y < roi.y0 || y >= roi.y0 + roi.height) return;
  const auto* pixel = layer.pixels.data() + static_cast<std::ptrdiff_t>(y - roi.y0) * roi.width;
  std::uint16_t* out = row + roi.x0 * 3;
  for (int x = 0; x < roi.width; ++x, ++pixel, out += 3) {
    const std::uint32_t through = 65535u - (*pixel)[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t light = (*pixel)[c] + (out[c] * through + 32767u) / 65535u;
      out[c] = static_cast<std::uint16_t>(light > 65535u ? 65535u : light);
    }
  }
}

}  // namespace

void FillBackground(std::span<const BackgroundShare> backgrounds, const RowBand& band, int width_px,
                    std::uint16_t* linear) {
  const int count = width_px * 3;
  // A warp writes one value beyond its row, which must not be the next band's.
  std::vector<std::uint16_t> row(static_cast<std::size_t>(count) + 1);
  std::vector<std::uint32_t> sum(static_cast<std::size_t>(count));
  for (int y = band.y0; y < band.y1; ++y) {
    std::uint16_t* out = linear + static_cast<std::ptrdiff_t>(y) * count;
    if (backgrounds.size() == 1) {
      backgrounds[0].warp.Row(y, row.data());
      std::copy_n(row.data(), count, out);
      continue;
    }
    std::fill(sum.begin(), sum.end(), 0);
    for (const BackgroundShare& background : backgrounds) {
      background.warp.Row(y, row.data());
      AddRow(row.data(), background.share, count, sum.data());
    }
    MeanRow(sum.data(), count, out);
  }
}

void ComposeRows(std::span<const TargetLayer> layers, const Sensor& sensor, const Shot& shot,
                 const RowBand& band, std::uint16_t* linear, RgbImage* image) {
  const int count = image->width_px * 3;
  for (int y = band.y0; y < band.y1; ++y) {
    std::uint16_t* row = linear + static_cast<std::ptrdiff_t>(y) * count;
    for (const TargetLayer& layer : layers) BlendRow(layer, y, row);
    sensor.Expose(shot, y, count, row);
    sensor.Transfer(row, count, image->Row(y));
  }
}

}  // namespace windhover
