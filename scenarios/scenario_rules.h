#pragma once

#include <string>

#include "scenarios/rule_findings.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Whether a method of estimator.methods knows nothing without `estimator.correction`.
bool NeedsCorrection(const std::string& method);

/// Adds to `findings` what is wrong between the fields of a scenario, each at its place in
/// `root`, the tree it was read from. Call before its aircraft are sorted.
void CheckRules(const Scenario& scenario, const ConfigNode& root, InputFiles files,
                Findings& findings);

}  // namespace windhover
