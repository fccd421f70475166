#pragma once

#include <cstdint>
#include <span>

#include "common/cpu/instruction_set.h"
#include "render/radiance_map.h"

namespace windhover {

/// Pixels between the places that a row of an image is interpolated from.
inline constexpr int kWarpCell_px = 16;

/// Most moments of an exposure that a row may be the mean of.
inline constexpr int kMaxWarpMoments = 5;

/// A share of 1.
inline constexpr std::int32_t kWholeShare = 32767;

/// A row of an image whose pixel 16 i looks at (u[i], v[i]) of a window, in 1/65536 texels, and
/// the pixels between on the straight line to the next place, by sixteenths of the way.
struct WarpedRow {
  const std::int32_t *u, *v;  ///< One more than there are cells, the last one begun included.
  int width_px;
  std::int32_t share = kWholeShare;  ///< Of a mean, in 32767ths.
};

/// Values beyond a row's last that a warp may write.
inline constexpr int kRowMargin = 2;

/// Interpolates linearly between four texels for each pixel of `row`: 3 · width_px values of
/// light, 65532 is white, true to 2. Integers only, so every instruction set gives the same bits.
/// Writes up to kRowMargin values more. `window` holds all places and one texel to the right of
/// and below each.
void WarpRow(const MapWindow& window, const WarpedRow& row, std::uint16_t* rgb,
             InstructionSet isa = WidestInstructionSet());

/// The mean of one row at several `moments` of an exposure, 1 to kMaxWarpMoments of one width whose
/// shares sum to kWholeShare. The shares are in the weights of the texels, each rounded to 1/32767,
/// so that one colour keeps its value, and the mean is true to 3 a moment elsewhere.
void WarpMeanRow(const MapWindow& window, std::span<const WarpedRow> moments, std::uint16_t* rgb,
                 InstructionSet isa = WidestInstructionSet());

}  // namespace windhover
