#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/scenario.h"

namespace windhover {

/// A scenario or a preset, which has no aircraft and no words and gets them. Nothing is drawn.
/// @throws ConfigError as LoadScenario.
Scenario LoadScenarioOrPreset(const std::filesystem::path& file,
                              std::vector<std::string> overrides);

/// A scenario or preset as the base of a data set (scenarios/dataset.h): no card of what was
/// learned before is needed. @throws ConfigError as LoadScenario.
Scenario LoadDatasetBase(const std::filesystem::path& file, std::vector<std::string> overrides);

}  // namespace windhover
