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

// The area that a disc, or a normal distribution, of this variance covers of each pixel. Averaging
// over pixels adds a pixel's own variance, which is taken off before.
Weights Wide(double variance, bool is_disc) {
  constexpr int kSubsamples = 8;
  constexpr double kPixelVariance = 1 / 12.0;
  const double sigma = std::sqrt(variance - kPixelVariance);
  const double extent = is_disc ? 2 * sigma : 4 * sigma;  // A disc's variance is r² / 4.
  Weights weights(std::min(kMaxRadius, static_cast<int>(std::ceil(extent + 0.5))));
  for (int dy = -weights.radius; dy <= weights.radius; ++dy) {
    for (int dx = -weights.radius; dx <= weights.radius; ++dx) {
      double sum = 0;
      for (int i = 0; i < kSubsamples * kSubsamples; ++i) {
        const double x = dx + (i % kSubsamples + 0.5) / kSubsamples - 0.5;
        const double y = dy + (i / kSubsamples + 0.5) / kSubsamples - 0.5;
        const double r2 = x * x + y * y;
        sum += is_disc ? (r2 < extent * extent ? 1 : 0) : std::exp(-r2 / (2 * sigma * sigma));
      }
      weights.At(dx, dy) = sum;
    }
  }
  return weights;
}

Weights Spread(double variance, bool is_disc) {
  constexpr double kNarrowVariance = 0.25;
  return variance < kNarrowVariance ? Narrow(variance) : Wide(variance, is_disc);
}

// Variances add.
Weights Convolved(Weights a, Weights b) {
  Weights both(a.radius + b.radius);
  for (int i = 0; i < (2 * a.radius + 1) * (2 * a.radius + 1); ++i) {
    const int dx = i % (2 * a.radius + 1) - a.radius, dy = i / (2 * a.radius + 1) - a.radius;
    for (int y = -b.radius; y <= b.radius; ++y) {
      for (int x = -b.radius; x <= b.radius; ++x) {
        both.At(dx + x, dy + y) += a.At(dx, dy) * b.At(x, y);
      }
    }
  }
  return both;
}

}  // namespace

// Integers only: the same bits from every clone.
__attribute__((target_clones("default", "avx2"))) void AddScaled(const std::uint16_t* values,
                                                                 std::uint32_t weight, int count,
                                                                 std::uint32_t* sums) {
  for (int i = 0; i < count; ++i) sums[i] += values[i] * weight;
}

PointSpread::PointSpread(double sigma_px, double disc_diameter_px) {
  Weights weights = Convolved(Spread(sigma_px * sigma_px, /*is_disc=*/false),
                              Spread(disc_diameter_px * disc_diameter_px / 16, /*is_disc=*/true));
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
