#pragma once

#include <array>
#include <optional>
#include <vector>

#include "rig/box_noise.h"

namespace windhover {

/// A target in both images and what a detector made of it.
struct BoxErrorSample {
  std::array<BoxSize, 2> sizes{};   ///< True sizes in left and right, px.
  std::optional<BoxErrors> errors;  ///< Found minus true; nothing: missed.
};

/// The noise of `observe: geometric` that errs like the detector which made these samples. Centres
/// by maximum likelihood of normal errors with deviation hypot(sigma_px, sigma_relative · size),
/// reweighted without what is beyond 3.5 deviations; correlation and its width by left minus right,
/// in the same way; what is beyond 3.5 deviations of that in x counts as gross, in one of both
/// images; misses by maximum likelihood of MissProbability(). A bias is not part of the model.
/// @throws std::invalid_argument of fewer than 50 samples with errors.
GeometricConfig FitBoxNoise(const std::vector<BoxErrorSample>& samples);

}  // namespace windhover
