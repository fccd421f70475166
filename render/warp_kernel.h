#pragma once

#include <cstdint>

#include "render/radiance_map.h"

namespace windhover {

/// A run of pixels along a row, whose places in a window go in a straight line from (u0, v0), by
/// sixteenths of the way to (u1, v1). Places are in 1/65536 texels.
struct WarpSpan {
  std::int32_t u0, v0, u1, v1;
  int count;  ///< At most 16.
};

/// Interpolates linearly between four texels for each pixel of `span`. Integers only, so every
/// processor gives the same bits. Writes 3 · count values and one more.
void WarpPixels(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb);

/// The same for processors with and without AVX2; WarpPixels chooses.
void WarpPixelsAvx2(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb);
void WarpPixelsSse2(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb);

}  // namespace windhover
