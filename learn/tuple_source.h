#pragma once

#include <cstdint>

#include "learn/stereo_tuple.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Every flight of `base.dataset` (scenarios/dataset.h), as `observe: geometric` would put its
/// boxes on the bus: the detections of the target that a run of the flight would score, with
/// score.reference as labels. `seed` makes another data set. The same bits on any number of
/// `threads`.
/// @param base as LoadUndrawnScenario reads it.
/// @throws as GeometricFlight (learn/geometric_flight.h).
TupleSplits DrawTuples(const Scenario& base, std::uint64_t seed, int threads);

}  // namespace windhover
