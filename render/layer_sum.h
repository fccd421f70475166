#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/target_canvas.h"
#include "render/target_layer.h"

namespace windhover {

/// A move of an image by whole samples.
struct SampleShift {
  int columns = 0, rows = 0;
};

/// Sums over boxes of samples, each in constant time. Source: F. Crow, "Summed-Area Tables for
/// Texture Mapping", SIGGRAPH 1984.
class BoxSums {
 public:
  /// Of the samples of the pixels `shown`, rows from the top.
  void Set(std::span<const TargetCanvas::Pixel> samples, const PixelRect& shown,
           int samples_per_px);

 private:
  friend class LayerSum;
  void AddCorners(int row, int from, int step,
                  std::span<std::array<std::uint32_t, 4>> corners) const;

  PixelRect shown_;
  int columns_ = 0, rows_ = 0;
  /// Of all samples above and to the left, modulo 2^32; (columns + 1) × (rows + 1).
  std::vector<std::array<std::uint32_t, 4>> sums_;
};

/// Gathers drawings and the times for which each stands into a layer.
class LayerSum {
 public:
  LayerSum(const PixelRect& roi, int samples_per_px);

  /// The sums of the pixels of the region from (x, y) on, to which drawings may be added.
  std::array<std::uint32_t, 4>* PixelsAt(int x, int y) {
    return sums_.data() + std::ptrdiff_t{y - layer_.roi.y0} * layer_.roi.width + x - layer_.roi.x0;
  }
  std::ptrdiff_t Stride() const { return layer_.roi.width; }

  /// Adds samples moved by each of `shifts`, as far as they are in the region then.
  void Add(const BoxSums& boxes, std::span<const SampleShift> shifts);

  /// Says what covers the samples in the middle of the exposure.
  void SetCover(const PixelRect& shown, std::span<const TargetLayer::Sample> cover,
                const SampleShift& shift);

  /// The mean over as many exposures as were added.
  TargetLayer Mean(std::size_t exposures) &&;

 private:
  TargetLayer layer_;
  /// Below 2^16 · 8² samples · 256 exposures = 2^30.
  std::vector<std::array<std::uint32_t, 4>> sums_;
};

}  // namespace windhover
