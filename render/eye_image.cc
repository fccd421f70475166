#include "render/eye_image.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace windhover {
namespace {

void ShadeRow(const std::uint16_t* shading, int count, std::uint16_t* row) {
  for (int i = 0; i < count; ++i) {
    row[i] = static_cast<std::uint16_t>((std::uint32_t{row[i]} * shading[i / 3] + 32768u) >> 16);
  }
}

void BlendRow(const TargetLayer& layer, int y, std::uint16_t* row) {
  const PixelRect& roi = layer.PixelRegion();
  if (y < roi.y0 || y >= roi.y0 + roi.height) return;
  const auto* pixel = layer.pixels.data() + static_cast<std::ptrdiff_t>(y - roi.y0) * roi.width;
  std::uint16_t* out = row + roi.x0 * 3;
  constexpr std::array<std::uint16_t, 4> kNothing{};
  for (int x = 0; x < roi.width; ++x, ++pixel, out += 3) {
    if (*pixel == kNothing) continue;
    const std::uint32_t through = 65535u - (*pixel)[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t light = (*pixel)[c] + (out[c] * through + 32767u) / 65535u;
      out[c] = static_cast<std::uint16_t>(light > 65535u ? 65535u : light);
    }
  }
}

}  // namespace

std::vector<std::uint16_t> ShadingOf(const RayGrid& rays, const OpticsConfig& optics) {
  if (!optics.vignetting) return {};
  std::vector<double> nodes;
  for (const Eigen::Vector3d& ray_C : rays.rays_C) {
    const double cos2 = ray_C.z() * ray_C.z();
    nodes.push_back(VignettingFactor(optics, (1 - cos2) / cos2));
  }
  std::vector<std::uint16_t> shading;
  for (int y = 0; y < rays.height_px; ++y) {
    const double v = y % kRayCell_px * (1.0 / kRayCell_px);
    for (int x = 0; x < rays.width_px; ++x) {
      const double u = x % kRayCell_px * (1.0 / kRayCell_px);
      const double* above = nodes.data() + y / kRayCell_px * rays.columns + x / kRayCell_px;
      const double* below = above + rays.columns;
      const double factor =
          (1 - v) * ((1 - u) * above[0] + u * above[1]) + v * ((1 - u) * below[0] + u * below[1]);
      shading.push_back(static_cast<std::uint16_t>(std::min(std::lround(factor * 65536), 65535L)));
    }
  }
  return shading;
}

TargetLayer SpreadLayer(const TargetLayer& layer, const PointSpread& spread, int width_px,
                        int height_px) {
  constexpr int kChannels = 4;
  if (layer.roi.IsEmpty() || spread.IsPoint()) return layer;
  const PixelRect& from = layer.roi;
  const int margin = spread.Radius();
  PixelRect to{std::max(from.x0 - margin, 0), std::max(from.y0 - margin, 0), 0, 0};
  to.width = std::min(from.x0 + from.width + margin, width_px) - to.x0;
  to.height = std::min(from.y0 + from.height + margin, height_px) - to.y0;
  const auto at = [&](int x, int y) {
    return static_cast<std::size_t>(y - to.y0) * static_cast<std::size_t>(to.width) +
           static_cast<std::size_t>(x - to.x0);
  };
  std::vector<std::array<std::uint16_t, kChannels>> sharp(static_cast<std::size_t>(to.width) *
                                                          static_cast<std::size_t>(to.height));
  for (int y = 0; y < from.height; ++y) {
    std::copy_n(layer.pixels.data() + static_cast<std::ptrdiff_t>(y) * from.width, from.width,
                sharp.data() + at(from.x0, from.y0 + y));
  }
  TargetLayer wider = layer;
  wider.spread_roi = to;
  wider.pixels.resize(sharp.size());
  const ImageView view{sharp.data()->data(), to.width, to.height, kChannels};
  for (int y = 0; y < to.height; ++y) {
    SpreadRow(view, spread, y, wider.pixels[at(to.x0, to.y0 + y)].data());
  }
  return wider;
}

void ComposeRow(std::span<const TargetLayer> layers, std::span<const std::uint16_t> shading,
                const Sensor& sensor, const Shot& shot, int y, std::uint16_t* row,
                RgbImage* image) {
  const int count = image->width_px * 3;
  for (const TargetLayer& layer : layers) BlendRow(layer, y, row);
  if (!shading.empty()) {
    ShadeRow(shading.data() + static_cast<std::ptrdiff_t>(y) * image->width_px, count, row);
  }
  sensor.Expose(shot, y, count, row);
  sensor.Transfer(row, count, image->Row(y));
}

}  // namespace windhover
