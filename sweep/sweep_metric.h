#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// Paths in score.json that a table has if its sweep does not say: errors of every method, targets
/// in view, separations.
std::vector<std::string> UsualMetrics(const Scenario& scenario);

/// Why no run of `scenario` has this metric in its score; empty: runs have it.
std::string WhyNoMetric(const Scenario& scenario, const std::string& path);

}  // namespace windhover
