#pragma once

#include <string>
#include <vector>

#include "common/config/config_node.h"
#include "scenarios/rule_findings.h"
#include "scenarios/scenario.h"

namespace windhover {

/// The scenario that a tree holds (LoadConfigTree, and whatever was changed in it since), checked.
/// Nothing is drawn; `held_keys` will not be.
/// @throws ConfigError as LoadScenario.
Scenario UndrawnScenarioOf(const ConfigNode& root, const std::vector<std::string>& held_keys,
                           InputFiles files = InputFiles::kMustExist);

/// What `randomize` lists, drawn, and what is wrong inside the vibration's file found.
/// @throws ConfigError as LoadScenario.
Scenario DrawnAndChecked(Scenario undrawn);

}  // namespace windhover
