#include <charconv>
#include <filesystem>
#include <iostream>
#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/budget_report.h"
#include "cli/command.h"
#include "common/file/whole_file.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string file, out, sweep;
  std::vector<std::string> overrides;
  std::vector<double> bearing_deg;
  BudgetPlan plan;
  bool as_json = false;
};

void WriteFiles(const std::string& folder, const std::string& name,
                const nlohmann::ordered_json& json, const std::string& text,
                const std::string& svg) {
  if (folder.empty()) return;
  fs::create_directories(folder);
  ReplaceFile(fs::path(folder) / (name + ".json"), json.dump(2) + "\n");
  ReplaceFile(fs::path(folder) / (name + ".txt"), text);
  ReplaceFile(fs::path(folder) / (name + ".svg"), svg);
}

// "a.b=1,2,3"
BudgetSweep ParseSweep(const std::string& text) {
  BudgetSweep sweep;
  const std::size_t equals = text.find('=');
  std::istringstream values(equals == std::string::npos ? "" : text.substr(equals + 1));
  sweep.key = text.substr(0, equals);
  for (std::string word; std::getline(values, word, ',');) {
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (read.ec != std::errc() || read.ptr != word.data() + word.size()) {
      sweep.values.clear();
      break;
    }
    sweep.values.push_back(value);
  }
  if (sweep.values.size() < 2 || sweep.key.empty()) {
    throw ConfigError(fmt::format("--sweep must be a.b.c=NUMBER,NUMBER,… (found '{}')", text));
  }
  return sweep;
}

int Sweep(const Options& options, const BudgetPlan& plan) {
  BudgetSweep sweep = ParseSweep(options.sweep);
  sweep.distances_m = plan.distances_m;
  for (const double value : sweep.values) {
    std::vector<std::string> overrides = options.overrides;
    overrides.push_back(fmt::format("{}={}", sweep.key, value));
    sweep.totals.push_back(ComputeErrorTotals(LoadScenario(options.file, overrides), plan));
  }
  const nlohmann::ordered_json json = SweepJson(sweep);
  WriteFiles(options.out, "sweep", json, SweepText(sweep), SweepSvg(sweep));
  std::cout << (options.as_json ? json.dump(2) + "\n" : SweepText(sweep));
  return kPass;
}

int Budget(const Options& options) {
  const Scenario scenario = LoadScenario(options.file, options.overrides);
  BudgetPlan plan = options.plan;
  if (options.bearing_deg.size() == 2) {
    plan.right_deg = options.bearing_deg[0];
    plan.down_deg = options.bearing_deg[1];
  }
  if (!options.sweep.empty()) return Sweep(options, plan);
  const ErrorBudget budget = ComputeErrorBudget(scenario, plan);
  const nlohmann::ordered_json json = BudgetJson(budget, plan);
  WriteFiles(options.out, "budget", json, BudgetText(budget), BudgetSvg(budget));
  std::cout << (options.as_json ? json.dump(2) + "\n" : BudgetText(budget));
  return kPass;
}

}  // namespace

void AddBudgetCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("budget", "error budget: what each disturbance costs in metres");
  command->add_option("SCENARIO", options->file, "scenario file")->required();
  command->add_option("--out", options->out, "folder for budget.json, .txt and .svg");
  command->add_option("--sweep", options->sweep,
                      "a.b.c=1,2,3: totals while this key changes; writes sweep.*");
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_option("--distances", options->plan.distances_m, "distances, m; default 5 … 40")
      ->check(CLI::Range(0.5, 1e4));
  command->add_option("--bearing", options->bearing_deg, "of the target, right and down, degrees")
      ->expected(2)
      ->check(CLI::Range(-60.0, 60.0));
  command->add_option("--flights", options->plan.n_flights, "flights to simulate")
      ->check(CLI::Range(2, 1000000));
  command->add_flag("--json", options->as_json, "print budget.json instead of a table");
  command->footer("Example: windhover budget scenarios/uavde_12mm.yaml --out budget");
  command->callback([=] { *chosen = [=] { return Budget(*options); }; });
}

}  // namespace windhover
