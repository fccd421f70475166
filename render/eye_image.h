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

/// Share of its light that each pixel keeps, in 65536ths; empty without vignetting.
std::vector<std::uint16_t> ShadingOf(const RayGrid& rays, const OpticsConfig& optics);

/// What `spread` makes of a target `layer` of an image of width × height px; its region grows.
TargetLayer SpreadLayer(const TargetLayer& layer, const PointSpread& spread, int width_px,
                        int height_px);

/// A row of an image from its parts: targets (`layers`, from far to near) over the surroundings
/// (`row`, which is used up), vignetting (`shading`, ShadingOf; empty: none), sensor.
///
/// Background and coverage are averaged over the exposure apart from each other, which is exact
/// where either is constant.
void ComposeRow(std::span<const TargetLayer> layers, std::span<const std::uint16_t> shading,
                const Sensor& sensor, const Shot& shot, int y, std::uint16_t* row, RgbImage* image);

}  // namespace windhover
