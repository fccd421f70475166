#pragma once

#include <string>
#include <vector>

#include "common/config/findings.h"
#include "sweep/sweep_config.h"

namespace windhover {

/// Adds to `findings` what is wrong between the fields of a sweep, each at its place in `root`.
void CheckSweepRules(const SweepConfig& config, const ConfigNode& root, Findings& findings);

/// Adds what names a metric that is not in the table, or that no run of `base` has.
/// @param metrics those of the table.
void CheckSweepMetrics(const SweepConfig& config, const std::vector<std::string>& metrics,
                       const Scenario& base, const ConfigNode& root, Findings& findings);

}  // namespace windhover
