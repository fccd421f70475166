#pragma once

#include "scenarios/rule_findings.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Rules between the fields of aircraft, and of what all of them carry and fly by.
void CheckAircraftRules(const Scenario& scenario, RuleFindings& findings);

}  // namespace windhover
