#pragma once

#include <memory>

#include "render/environment.h"

namespace windhover {

/// An equirectangular panorama: its middle is east, its top row the zenith. High dynamic range
/// is exposed so that the log-mean is 0.18, with a soft shoulder towards white (E. Reinhard et
/// al., "Photographic Tone Reproduction", SIGGRAPH 2002, eq. 4).
/// @throws ConfigError if the file is no image, or not twice as wide as high within 5 %.
std::unique_ptr<Environment> MakePanoramaEnvironment(const InputFile& file);

/// A photo that fills `width_deg` of azimuth about east, its middle on the horizon, repeated
/// mirrored outside.
/// @throws ConfigError if the file is no image.
std::unique_ptr<Environment> MakePhotoEnvironment(const InputFile& file, double width_deg);

}  // namespace windhover
