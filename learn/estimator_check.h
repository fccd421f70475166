#pragma once

#include "scenarios/aircraft_config.h"

namespace windhover {

/// Reads what the estimators that `config` lists depend on, as their process would.
/// @throws ConfigError saying what is wrong with estimator.correction or detector_model and where.
void CheckEstimators(const AircraftConfig& config);

}  // namespace windhover
