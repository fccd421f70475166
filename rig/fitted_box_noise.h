#pragma once

#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "rig/box_noise.h"

namespace windhover {

/// The section "box_noise" of a detector's card: the keys of `geometric` but `noise`, each once.
nlohmann::ordered_json BoxNoiseJson(const GeometricConfig& fitted);

/// What a detector's card says of how its boxes err, for `geometric.noise: fitted`.
/// @throws ConfigError where the scenario names the card, if it cannot be read, has no box_noise or
/// a value beyond its limits.
GeometricConfig ReadFittedBoxNoise(const InputFile& card);

}  // namespace windhover
