#pragma once

#include <filesystem>

#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// Every aircraft at its scenario's start position and heading, at rest, at time `t_s`.
world_truth_t StartWorld(const Scenario& scenario, double t_s);

/// Reads an encoded world_truth_t. @throws ConfigError if the file holds none.
world_truth_t ReadWorld(const std::filesystem::path& file);

/// Renders one instant as the first aircraft with a rig sees it, and writes left.png, right.png
/// and labels.json (the annotation) into `out`, which is made if need be. The tick, which
/// seeds the noise, is the one whose time is nearest.
/// @throws ConfigError if no aircraft carries a rig; std::runtime_error if a file cannot be
/// written.
void WriteSnapshot(const Scenario& scenario, const world_truth_t& world, int threads,
                   const std::filesystem::path& out);

}  // namespace windhover
