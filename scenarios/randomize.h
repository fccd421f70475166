#pragma once

#include "common/config/config_node.h"
#include "common/config/findings.h"
#include "scenarios/scenario.h"

namespace windhover {

/// `scenario` as one run or one flight of a data set has it: every key that `randomize` lists has
/// a value, whatever it was before, and the list is empty. A function of `random_seed` and the key
/// alone, so that another key in the list changes no draw.
/// @throws ConfigError if what is drawn breaks a rule between keys.
Scenario Drawn(Scenario scenario);

/// Adds to `findings` what is wrong with `scenario.randomize`, each at its place in `root`: keys
/// that cannot be drawn, and values that they must not have.
void CheckRandomized(const Scenario& scenario, const ConfigNode& root, Findings& findings);

}  // namespace windhover
