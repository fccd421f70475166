#include "scenarios/scenario.h"

#include <algorithm>

#include "common/config/config_reader.h"
#include "common/config/config_tree.h"
#include "common/config/config_writer.h"
#include "rig/base_vibration.h"
#include "rig/fitted_box_noise.h"
#include "scenarios/randomize.h"
#include "scenarios/scenario_rules.h"
#include "scenarios/scenario_tree.h"

namespace windhover {
namespace {

Scenario ReadScenario(const ConfigNode& root, InputFiles files) {
  Scenario scenario;
  Findings findings;
  ReadConfig(root, scenario, findings);
  CheckRules(scenario, root, files, findings);
  CheckRandomized(scenario, root, findings);
  findings.ThrowIfAny();
  std::sort(scenario.aircraft.begin(), scenario.aircraft.end(),
            [](const Aircraft& a, const Aircraft& b) { return a.self.id < b.self.id; });
  return scenario;
}

}  // namespace

AircraftConfig Scenario::ForAircraft() const {
  AircraftConfig config{.frame_rate_hz = frame_rate_hz,
                        .observe = observe,
                        .rig = rig.calibrated,
                        .estimator = estimator,
                        .swarm = swarm,
                        .aircraft = {}};
  for (const Aircraft& one : aircraft) config.aircraft.push_back(one.self);
  return config;
}

Scenario UndrawnScenarioOf(const ConfigNode& root, const std::vector<std::string>& held_keys,
                           InputFiles files) {
  Scenario scenario = ReadScenario(root, files);
  if (scenario.geometric.noise == BoxNoiseSource::kFitted) {
    scenario.geometric = ReadFittedBoxNoise(scenario.estimator.detector_model);
  }
  std::erase_if(scenario.randomize, [&](const RandomizedKey& randomized) {
    return std::find(held_keys.begin(), held_keys.end(), randomized.key) != held_keys.end();
  });
  return scenario;
}

Scenario DrawnAndChecked(Scenario undrawn) {
  const Scenario scenario = Drawn(std::move(undrawn));
  // What is wrong inside the file of the vibration comes out here, before any process starts.
  MakeBaseVibration(scenario.vibration, scenario.random_seed, "");
  return scenario;
}

Scenario LoadUndrawnScenario(const std::filesystem::path& file,
                             const std::vector<std::string>& overrides) {
  ConfigNode root = LoadConfigTree(file);
  std::vector<std::string> held_keys;
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    ApplyOverride(root, overrides[i], static_cast<int>(i) + 1);
    held_keys.push_back(overrides[i].substr(0, overrides[i].find('=')));
  }
  return UndrawnScenarioOf(root, held_keys);
}

Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides) {
  return DrawnAndChecked(LoadUndrawnScenario(file, overrides));
}

Scenario ScenarioFromYaml(const std::string& resolved_yaml, const std::string& name) {
  return ReadScenario(ParseYaml(resolved_yaml, {name, {}}), InputFiles::kNotNeeded);
}

AircraftConfig LoadAircraftConfig(const std::filesystem::path& file) {
  return LoadScenario(file).ForAircraft();
}

std::string ResolvedYaml(const Scenario& scenario, PathStyle style) {
  return WriteConfig(scenario, style);
}

std::string LogHeaderYaml(Scenario scenario) {
  scenario.execution = {};
  return WriteConfig(scenario, PathStyle::kNameOnly);
}

}  // namespace windhover
