#pragma once

#include <cstdint>
#include <vector>

namespace windhover {

/// What becomes of a point's light in an image: a disc (defocus) and a normal distribution
/// (diffraction) together, as weights of pixels.
///
/// The image's own pixels are already averages over their area, so that the weights have the
/// variance of disc and distribution alone: each, if narrow, is three weights a row that have its
/// variance, else the area that it covers of each pixel; the kernel is their convolution.
class PointSpread {
 public:
  /// A tap of the kernel: the pixel (dx, dy) away gets weight / 65536.
  struct Tap {
    int dx, dy;
    std::uint32_t weight;
  };

  /// Disc and distribution are cut at 32 px from their middles.
  PointSpread(double sigma_px, double disc_diameter_px);

  /// Row by row; the weights sum to 65536.
  const std::vector<Tap>& Taps() const { return taps_; }
  int Radius() const { return radius_; }
  bool IsPoint() const { return radius_ == 0; }

  /// Variance along one axis, px².
  double Variance() const;

 private:
  std::vector<Tap> taps_;
  int radius_ = 0;
};

/// Adds `count` values times `weight` to `sums`.
void AddScaled(const std::uint16_t* values, std::uint32_t weight, int count, std::uint32_t* sums);

/// An image of `channels` values a pixel, rows from the top without gaps.
struct ImageView {
  const std::uint16_t* values;
  int width_px, height_px, channels;
};

/// Row `y` of what `spread` makes of `image`, width · channels values; beyond its borders the image
/// is taken to go on as it ends. Integers only: the same bits everywhere.
void SpreadRow(const ImageView& image, const PointSpread& spread, int y, std::uint16_t* row);

}  // namespace windhover
