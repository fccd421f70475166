#include "cli/dataset_scenario.h"

namespace windhover {

Scenario LoadScenarioOrPreset(const std::filesystem::path& file,
                              std::vector<std::string> overrides) {
  if (file.parent_path().filename() == "presets") {
    overrides.insert(overrides.begin(), {"aircraft=[{id: 0}]", "description=preset"});
  }
  return LoadUndrawnScenario(file, overrides);
}

Scenario LoadDatasetBase(const std::filesystem::path& file, std::vector<std::string> overrides) {
  overrides.insert(overrides.end(), {"observe=geometric", "estimator.methods=[baseline]",
                                     "estimator.in_loop=baseline", "estimator.correction=''"});
  return LoadScenarioOrPreset(file, std::move(overrides));
}

}  // namespace windhover
