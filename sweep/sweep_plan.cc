#include "sweep/sweep_plan.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "common/config/config_reader.h"
#include "common/config/config_tree.h"
#include "common/config/config_writer.h"
#include "common/file/sha256.h"
#include "scenarios/input_files.h"
#include "scenarios/scenario_tree.h"
#include "sweep/sweep_metric.h"
#include "sweep/sweep_rules.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxMistakes = 20;
constexpr const char* kSweep = "sweep";  // In plan.json: gates and analysis change no run.

std::vector<std::string> KeysOf(const std::vector<Factor>& factors) {
  std::vector<std::string> keys;
  for (const Factor& factor : factors) keys.push_back(factor.key());
  return keys;
}

/// Dotted paths of all values below `node`.
void ListPaths(const ConfigNode& node, const std::string& path, std::vector<std::string>* paths) {
  if (!node.IsMap()) return paths->push_back(path);
  for (const auto& entry : node.entries) {
    ListPaths(entry.value, path.empty() ? entry.key : path + "." + entry.key, paths);
  }
}

/// The base scenario with `set` on top.
ConfigNode BaseTree(const InputFile& base, const ConfigNode& set) {
  ConfigNode root = LoadConfigTree(base.absolute);
  if (set.kind == ConfigNode::Kind::kNothing) return root;
  if (!set.IsMap()) {
    throw ConfigError(
        fmt::format("{}: set: must be a map (found {})", set.where.ToString(), set.Found()));
  }
  if (const ConfigNode* extends = set.Find("extends")) {
    throw ConfigError(
        fmt::format("{}: set.extends: must be left out, base names the file (found {})",
                    extends->where.ToString(), extends->Found()));
  }
  MergeInto(root, set);
  return root;
}

/// Where sweep.yaml says that factor `f` has this value.
SourceLocation PlaceOf(const SweepPlan& plan, std::size_t f, const std::string& value) {
  const FactorConfig& config = plan.config.factors[f];
  std::string at = "key";
  if (const auto index = plan.factors[f].IndexOf(value)) at = fmt::format("values.{}", *index);
  if (NumberOf(value) == config.min) at = "min";
  if (NumberOf(value) == config.max) at = "max";
  return NearestNode(plan.source, fmt::format("factors.{}.{}", f, at)).where;
}

/// The value that the base scenario has for each factor's key, written or by default.
DesignPoint NominalPoint(const SweepPlan& plan, const Scenario& base) {
  const ConfigNode resolved = ParseYaml(ResolvedYaml(base, PathStyle::kAbsolute), {"base", {}});
  DesignPoint nominal;
  for (const Factor& factor : plan.factors) {
    const ConfigNode& written = NearestNode(plan.base, factor.key());
    const ConfigNode& node = written.IsScalar() ? written : NearestNode(resolved, factor.key());
    nominal.push_back(node.IsScalar() ? node.scalar : "");
  }
  return nominal;
}

/// Builds the scenario of every point; what is wrong is said once, with the first point that has
/// it.
void CheckPoints(const SweepPlan& plan) {
  std::set<std::string> seen;
  std::string mistakes;
  for (std::size_t i = 0; i < plan.points.size() && seen.size() <= kMaxMistakes; ++i) {
    try {
      Scenario scenario = plan.ScenarioAt(i);
      scenario.random_seed = plan.SeedOf(0);
      DrawnAndChecked(std::move(scenario));
    } catch (const ConfigError& error) {
      std::istringstream lines(error.what());
      for (std::string line; std::getline(lines, line);) {
        if (!seen.insert(line).second) continue;
        const std::string place =
            plan.factors.empty() ? "" : fmt::format("; at point {}: {}", i, plan.Describe(i));
        mistakes += fmt::format("{}{}{}", mistakes.empty() ? "" : "\n", line, place);
      }
    }
  }
  if (!mistakes.empty()) throw ConfigError(mistakes);
}

Scenario UndrawnOf(const SweepPlan& plan, const ConfigNode& root) {
  if (!plan.config.retrain) return UndrawnScenarioOf(root, plan.held_keys);
  Scenario scenario = UndrawnScenarioOf(root, plan.held_keys, InputFiles::kCardComesLater);
  scenario.estimator.correction = {};
  return scenario;
}

void TakeFactors(SweepPlan* plan) {
  for (std::size_t f = 0; f < plan->config.factors.size(); ++f) {
    plan->factors.emplace_back(plan->config.factors[f]);
    plan->held_keys.push_back(plan->config.factors[f].key);
    plan->key_places.push_back(NearestNode(plan->source, fmt::format("factors.{}.key", f)).where);
  }
}

}  // namespace

Scenario SweepPlan::ScenarioAt(std::size_t point) const {
  ConfigNode root = base;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    ConfigNode value;
    value.kind = ConfigNode::Kind::kScalar;
    value.scalar = points[point][f];
    value.where = PlaceOf(*this, f, value.scalar);
    SetNode(root, factors[f].key(), key_places[f], value);
  }
  return UndrawnOf(*this, root);
}

Scenario SweepPlan::BaseScenario() const { return UndrawnOf(*this, base); }

std::size_t SweepPlan::FactorNamed(const std::string& key) const {
  const auto at = std::find_if(factors.begin(), factors.end(),
                               [&](const Factor& factor) { return factor.key() == key; });
  return static_cast<std::size_t>(at - factors.begin());
}

std::string SweepPlan::Describe(std::size_t point) const {
  std::string text;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    text += fmt::format("{}{} = {}", f == 0 ? "" : ", ", factors[f].key(), points[point][f]);
  }
  return text;
}

SweepPlan LoadSweepPlan(const fs::path& file) { return SweepPlanOf(LoadConfigTree(file)); }

SweepPlan SweepPlanOf(ConfigNode source) {
  SweepPlan plan;
  plan.source = std::move(source);
  const ConfigNode set = TakeNode(plan.source, "set");
  Findings findings;
  ReadConfig(plan.source, plan.config, findings);
  CheckSweepRules(plan.config, plan.source, findings);
  findings.ThrowIfAny();
  plan.base = BaseTree(plan.config.base, set);
  ListPaths(set, "", &plan.held_keys);
  const Scenario base = plan.BaseScenario();
  TakeFactors(&plan);
  plan.metrics = plan.config.metrics.empty() ? UsualMetrics(base) : plan.config.metrics;
  CheckSweepMetrics(plan.config, plan.metrics, base, plan.source, findings);
  findings.ThrowIfAny();
  plan.points = DesignPoints(plan.config.design, plan.factors, NominalPoint(plan, base));
  CheckPoints(plan);
  return plan;
}

Json PlanJson(const SweepPlan& plan, const std::string& build) {
  Json inputs = Json::object();
  const bool has_words = std::any_of(plan.factors.begin(), plan.factors.end(),
                                     [](const Factor& factor) { return !factor.is_number(); });
  for (std::size_t i = 0; i < (has_words ? plan.points.size() : 1); ++i) {
    // Files by name and content: where they lie differs between machines.
    for (const NamedInputFile& input : InputFilesOf(plan.ScenarioAt(i))) {
      const std::string name = fs::path(input.file.absolute).filename().string();
      if (!inputs.contains(name)) inputs[name] = Sha256OfFile(input.file.absolute);
    }
  }
  return {{"build", build},
          {"scenario", LogHeaderYaml(plan.BaseScenario())},
          {"inputs", inputs},
          {"factors", KeysOf(plan.factors)},
          {"points", plan.points},
          {"seeds", WriteConfig(plan.config.seeds, PathStyle::kNameOnly)},
          {"stop", WriteConfig(plan.config.stop, PathStyle::kNameOnly)},
          {"metrics", plan.metrics},
          {"retrain", plan.config.retrain},
          {kSweep, WriteConfig(plan.config, PathStyle::kNameOnly)}};
}

std::string DifferenceOfPlans(const Json& a, const Json& b) {
  for (const auto& [key, value] : a.items()) {
    if (key != kSweep && (!b.contains(key) || b[key] != value)) return key;
  }
  return "";
}

StoredPlan ReadPlan(const fs::path& file) {
  StoredPlan stored;
  std::ifstream in(file);
  stored.json = Json::parse(in, nullptr, /*allow_exceptions=*/false);
  SweepPlan& plan = stored.plan;
  try {
    plan.source = ParseYaml(stored.json.at(kSweep), {file.string() + "#sweep", {}});
    Findings findings;
    ReadConfig(plan.source, plan.config, findings);
    findings.ThrowIfAny();
    TakeFactors(&plan);
    plan.metrics = stored.json.at("metrics").get<std::vector<std::string>>();
    plan.points = stored.json.at("points").get<std::vector<DesignPoint>>();
  } catch (const Json::exception&) {
    throw ConfigError(fmt::format("{}: must be the plan.json of a sweep (found {})", file.string(),
                                  fs::exists(file) ? "something else" : "no such file"));
  }
  return stored;
}

}  // namespace windhover
