#pragma once

#include <memory>

#include "render/environment.h"

namespace windhover {

/// The procedural scenes (playground, forest, buildings, basketball court): sky with sun and
/// clouds, rows of things that stand at a distance, and flat ground with its markings, seen from
/// a height that each scene states.
std::unique_ptr<Environment> MakeOutdoorEnvironment(const EnvironmentConfig& config);

}  // namespace windhover
