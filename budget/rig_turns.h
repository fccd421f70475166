#pragma once

#include <array>

#include "scenarios/scenario.h"

namespace windhover {

/// Root mean square of the angles by which vibration turns the rig about its axes (right, down,
/// forward) within `lag_s`, which itself spreads by `lag_sigma_s`, in closed form: of each line of
/// amplitude A, A² (1 - cos(ω lag) exp(-ω² lag_sigma² / 2)).
/// @throws ConfigError if a vibration file cannot be used.
std::array<double, 3> RigTurnsWithin(const Scenario& scenario, double lag_s, double lag_sigma_s);

}  // namespace windhover
