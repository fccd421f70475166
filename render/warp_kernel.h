#pragma once

#include <cstdint>

#include "common/cpu/instruction_set.h"
#include "render/radiance_map.h"

namespace windhover {

/// Pixels between the places that a row of an image is interpolated from.
inline constexpr int kWarpCell_px = 16;

/// A row of an image whose pixel 16 i looks at (u[i], v[i]) of a window, in 1/65536 texels, and
/// the pixels between on the straight line to the next place, by sixteenths of the way.
struct WarpedRow {
  const std::int32_t *u, *v;  ///< One more than there are cells, the last one begun included.
  int width_px;
};

/// Values beyond a row's last that a warp may write.
inline constexpr int kRowMargin = 2;

/// Interpolates linearly between four texels for each pixel of `row`: 3 · width_px values of
/// light, 65532 is white, true to 2. Integers only, so every instruction set gives the same bits.
/// Writes up to kRowMargin values more. `window` holds all places and one texel to the right of
/// and below each.
void WarpRow(const MapWindow& window, const WarpedRow& row, std::uint16_t* rgb,
             InstructionSet isa = WidestInstructionSet());

}  // namespace windhover
