#pragma once

#include <vector>

#include "eval/metrics.h"
#include "learn/stereo_tuple.h"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Scores of `config.estimator.methods` on recorded detections, as of a run that had them: each
/// flight is seen from its beginning, in order of time, by a rig that keeps its attitude, at rest.
/// The reference is each tuple's label.
/// @throws as MakeRangeEstimator.
std::vector<MethodScore> ScoreTuples(const std::vector<StereoTuple>& tuples,
                                     const AircraftConfig& config);

}  // namespace windhover
