#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/image/rgb_image.h"
#include "render/background.h"
#include "render/sensor.h"
#include "render/target_pass.h"

namespace windhover {

/// The surroundings at one moment of the exposure, and its share of the mean in 65536ths.
struct BackgroundShare {
  BackgroundWarp warp;
  std::uint32_t share;
};

/// One image from its parts: weighted mean of the surroundings, targets over it from far to
/// near (`layers` in that order), sensor. Works row by row, so that only bytes leave the cache.
///
/// Background and coverage are averaged over the exposure apart from each other, which is exact
/// where either is constant.
RgbImage ComposeImage(std::span<const BackgroundShare> backgrounds,
                      std::span<const TargetLayer> layers, const Sensor& sensor,
                      const NoiseKey& key, int width_px, int height_px);

}  // namespace windhover
