#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/projected_mesh.h"

namespace windhover {

/// One target as one camera sees it during one exposure, without the others.
struct TargetLayer {
  PixelRect roi;
  PixelRect spread_roi;  ///< Of `pixels`, where a lens spread them beyond the samples; else empty.
  /// Linear light times coverage (65535 is white) and coverage; mean over the exposure.
  std::vector<std::array<std::uint16_t, 4>> pixels;
  /// Samples of the middle of the exposure, samples_per_px² a pixel, rows from the top.
  int samples_per_px = 1;
  enum class Sample : std::uint8_t { kEmpty, kTranslucent, kOpaque };
  std::vector<Sample> samples;

  /// Where `pixels` are.
  const PixelRect& PixelRegion() const { return spread_roi.IsEmpty() ? roi : spread_roi; }

  Sample SampleAt(double x_px, double y_px) const;
};

}  // namespace windhover
