#pragma once

#include <cstdint>

#include "scenarios/scenario.h"

namespace windhover {

/// Flight number `flight` (from 0) of a split of the data set that `base.dataset` describes: a
/// scenario of its own, with a seed of its own, so that its rig, noise, path and all that
/// `randomize` lists are. `seed` makes another data set. Flights of different splits never share a
/// seed.
///
/// The first aircraft of `base` with a rig holds its place and looks at the first other one; a
/// P600 and an orange M200 stand in for those that `base` lacks. The target goes between
/// `nearest_m` and `farthest_m` such that equal times pass in equal shares of the wanted
/// distances, wanders through the part of the view in which both cameras see all of it, and tilts
/// by accelerating. Training flights are over other surroundings than the rest, as in UAVDE; every
/// flight has light and air of its own.
/// @pre 0 <= flight < base.dataset.Of(split).flights
Scenario DatasetFlight(const Scenario& base, Split split, int flight, std::uint64_t seed);

}  // namespace windhover
