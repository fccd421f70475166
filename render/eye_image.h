#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/image/rgb_image.h"
#include "render/background.h"
#include "render/point_spread.h"
#include "render/sensor.h"
#include "render/target_pass.h"
#include "rig/optics.h"

namespace windhover {

/// The surroundings at one moment of the exposure, and its share of the mean in 65536ths.
struct BackgroundShare {
  BackgroundWarp warp;
  std::uint32_t share;
};

/// Rows [y0, y1) of an image, as part of the work on it.
struct RowBand {
  int y0, y1;
};

/// Weighted mean of the surroundings over the exposure: linear light, 3 · width_px values a row,
/// into the rows of `band` of `linear` (a whole image, and one value more).
void FillBackground(std::span<const BackgroundShare> backgrounds, const RowBand& band, int width_px,
                    std::uint16_t* linear);

/// Share of its light that each pixel keeps, in 65536ths; empty without vignetting.
std::vector<std::uint16_t> ShadingOf(const RayGrid& rays, const OpticsConfig& optics);

/// What `spread` makes of a target `layer` of an image of width × height px; its region grows.
TargetLayer SpreadLayer(const TargetLayer& layer, const PointSpread& spread, int width_px,
                        int height_px);

/// An image from its parts: targets over the surroundings from far to near (`layers` in that
/// order), vignetting (`shading`, ShadingOf; empty: none), sensor. `linear` is used up.
///
/// Background and coverage are averaged over the exposure apart from each other, which is exact
/// where either is constant.
void ComposeRows(std::span<const TargetLayer> layers, std::span<const std::uint16_t> shading,
                 const Sensor& sensor, const Shot& shot, const RowBand& band, std::uint16_t* linear,
                 RgbImage* image);

}  // namespace windhover
