#include "render/point_spread.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr int kMaxRadius = 32;

// Weights by position, of either kind of spread; any scale.
struct Weights {
  int radius;
  std::vector<double> values;  ///< (2 radius + 1)², row by row.

  explicit Weights(int r)
      : radius(r),
        values(static_cast<std::size_t>(2 * r + 1) * static_cast<std::size_t>(2 * r + 1)) {}
  double& At(int dx, int dy) {
    return values[static_cast<std::size_t>((dy + radius) * (2 * radius + 1) + dx + radius)];
  }
};

// Three a row, with exactly this variance along each axis.
Weights Narrow(double variance) {
  Weights weights(variance > 0 ? 1 : 0);
  const double side = variance / 2;
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    for (int dx = -weights.radius; dx <= weights.radius; ++dx) {
      weights.At(dx, dy) = (dx == 0 ? 1 - 2 * side : side) * (dy == 0 ? 1 - 2 * side : side);
    }
  }
  return weights;
}

// Share of a disc of `radius` whose edge is blurred by `sigma` (both px) at a distance from its
// middle, to a constant factor.
double Profile(double distance, double radius, double sigma) {
  if (radius < 0.5 * sigma) return std::exp(-distance * distance / (2 * sigma * sigma));
  if (sigma < 1e-3) return distance < radius ? 1 : 0;
  return std::erfc((distance - radius) / (sigma * std::sqrt(2.0)));
}

Weights Wide(double sigma, double radius) {
  constexpr int kSubsamples = 8;
  Weights weights(std::min(kMaxRadius, static_cast<int>(std::ceil(radius + 3 * sigma + 0.5))));
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    for (int dx = -weights.radius; dx <= weights.radius; ++dx) {
      double sum = 0;
      for (int i = 0; i < kSubsamples * kSubsamples; ++i) {
        const double x = dx + (i % kSubsamples + 0.5) / kSubsamples - 0.5;
        const double y = dy + (i / kSubsamples + 0.5) / kSubsamples - 0.5;
        sum += Profile(std::hypot(x, y), radius, sigma);
      }
      weights.At(dx, dy) = sum;
    }
  }
  return weights;
}

__attribute__((target_clones("default", "avx2"))) void AddScaled(const std::uint16_t* values,
                                                                 std::uint32_t weight, int count,
                                                                 std::uint32_t* sums) {
  for (int i = 0; i < count; ++i) sums[i] += values[i] * weight;
}

}  // namespace

PointSpread::PointSpread(double sigma_px, double disc_diameter_px) {
  constexpr double kPixelVariance = 1 / 12.0, kNarrowVariance = 0.25;
  // Of a disc along one axis: r² / 4.
  const double disc_variance = disc_diameter_px * disc_diameter_px / 16;
  const double variance = sigma_px * sigma_px + disc_variance;
  const double left = std::max(sigma_px * sigma_px - kPixelVariance, 0.0);
  const double taken = sigma_px * sigma_px - left;
  Weights weights =
      variance < kNarrowVariance
          ? Narrow(variance)
          : Wide(std::sqrt(left),
                 2 * std::sqrt(std::max(disc_variance - (kPixelVariance - taken), 0.0)));
  radius_ = weights.radius;
  double sum = 0;
  for (const double value : weights.values) sum += value;
  std::uint32_t rest = 65536;
  for (int dy = -radius_; dy <= radius_; ++dy) {
    for (int dx = -radius_; dx <= radius_; ++dx) {
      const auto weight = static_cast<std::uint32_t>(std::lround(weights.At(dx, dy) / sum * 65536));
      if (weight == 0 && !(dx == 0 && dy == 0)) continue;
      taps_.push_back({dx, dy, weight});
      rest -= weight;  // Modulo 2³²: rounding may overdraw.
    }
  }
  for (Tap& tap : taps_) {
    if (tap.dx == 0 && tap.dy == 0) tap.weight += rest;
  }
}

double PointSpread::Variance() const {
  double sum = 0;
  for (const Tap& tap : taps_) sum += tap.weight * static_cast<double>(tap.dx * tap.dx);
  return sum / 65536;
}

void SpreadRow(const ImageView& image, const PointSpread& spread, int y, std::uint16_t* row) {
  const int channels = image.channels, margin = spread.Radius() * channels;
  const int count = image.width_px * channels;
  std::vector<std::uint32_t> sums(static_cast<std::size_t>(count), 32768);
  std::vector<std::uint16_t> padded(static_cast<std::size_t>(count + 2 * margin));
  int padded_row = -1;
  for (const PointSpread::Tap& tap : spread.Taps()) {
    const int source = std::clamp(y + tap.dy, 0, image.height_px - 1);
    if (source != padded_row) {
      padded_row = source;
      const std::uint16_t* values = image.values + static_cast<std::ptrdiff_t>(source) * count;
      std::copy_n(values, count, padded.data() + margin);
      for (int i = 0; i < margin; ++i) {
        padded[static_cast<std::size_t>(i)] = values[i % channels];
        padded[static_cast<std::size_t>(margin + count + i)] =
            values[count - channels + i % channels];
      }
    }
    AddScaled(padded.data() + margin + tap.dx * channels, tap.weight, count, sums.data());
  }
  for (int i = 0; i < count; ++i) {
    row[i] = static_cast<std::uint16_t>(sums[static_cast<std::size_t>(i)] >> 16);
  }
}

}  // namespace windhover
