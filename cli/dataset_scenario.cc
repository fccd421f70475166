#include "cli/dataset_scenario.h"

namespace windhover {

Scenario LoadDatasetBase(const std::filesystem::path& file, std::vector<std::string> overrides) {
  if (file.parent_path().filename() == "presets") {
    overrides.insert(overrides.begin(), {"aircraft=[{id: 0}]", "description=preset"});
  }
  overrides.insert(overrides.end(), {"observe=geometric", "estimator.methods=[baseline]",
                                     "estimator.in_loop=baseline", "estimator.correction=''"});
  return LoadUndrawnScenario(file, overrides);
}

}  // namespace windhover
