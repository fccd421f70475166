#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "common/config/config_node.h"
#include "scenarios/scenario.h"
#include "sweep/design.h"
#include "sweep/sweep_config.h"

namespace windhover {

/// Every run of a sweep, before any of them.
struct SweepPlan {
  SweepConfig config;
  std::vector<Factor> factors;
  std::vector<DesignPoint> points;
  std::vector<std::string> metrics;  ///< Paths in score.json.

  std::uint64_t SeedOf(int run) const {
    return config.seeds.first + static_cast<std::uint64_t>(run);
  }

  /// The scenario of a point with nothing drawn; its random_seed is still to be set, and where
  /// `retrain` is true its estimator.correction.
  Scenario ScenarioAt(std::size_t point) const;

  /// The same without factors.
  Scenario BaseScenario() const;

  /// Index of the factor with this key; the number of factors if there is none.
  std::size_t FactorNamed(const std::string& key) const;

  /// "rig.focal_mm = 12, vibration.level = 2"
  std::string Describe(std::size_t point) const;

  ConfigNode base;                         ///< The base scenario with `set`.
  std::vector<std::string> held_keys;      ///< Of `set` and the factors.
  std::vector<SourceLocation> key_places;  ///< Of each factor's key in sweep.yaml.
  ConfigNode source;                       ///< sweep.yaml, for messages.
};

/// Reads a sweep, and the scenario of every point of it.
/// @throws ConfigError listing every mistake at its place, those that only some points have, too.
SweepPlan LoadSweepPlan(const std::filesystem::path& file);

/// The same of a tree that is already read.
SweepPlan SweepPlanOf(ConfigNode source);

/// The content of plan.json: all that the table follows from, and sweep.yaml. `build`: which
/// program.
nlohmann::ordered_json PlanJson(const SweepPlan& plan, const std::string& build);

/// The key of plan.json in which two plans differ so that their runs may differ too; "" if in none.
std::string DifferenceOfPlans(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

/// A plan as its file has it: enough for tables and analysis, not for runs.
/// @throws ConfigError naming the file if it is no plan.json.
struct StoredPlan {
  nlohmann::ordered_json json;
  SweepPlan plan;
};
StoredPlan ReadPlan(const std::filesystem::path& file);

}  // namespace windhover
