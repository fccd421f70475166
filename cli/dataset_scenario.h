#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// A scenario or preset as the base of a data set (scenarios/dataset.h): nothing is drawn, no card
/// of what was learned before is needed. A preset, which has no aircraft and no words, gets them.
/// @throws ConfigError as LoadScenario.
Scenario LoadDatasetBase(const std::filesystem::path& file, std::vector<std::string> overrides);

}  // namespace windhover
