#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "learn/estimator_check.h"
#include "scenarios/scenario.h"

namespace windhover {
namespace {

struct CheckOptions {
  std::string file;
  std::vector<std::string> overrides;
  bool resolved = false;
};

int Check(const CheckOptions& options) {
  const Scenario scenario = LoadScenario(options.file, options.overrides);
  CheckEstimators(scenario.ForAircraft());
  if (options.resolved) {
    fmt::print("{}", ResolvedYaml(scenario, PathStyle::kAbsolute));
  } else {
    fmt::print("{}: no mistakes: {}\n", options.file, scenario.description);
  }
  return kPass;
}

}  // namespace

void AddCheckCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command =
      app.add_subcommand("check", "reads a scenario, prints every mistake, starts nothing");
  command->add_option("SCENARIO", options->file, "scenario file")->required();
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_flag("--resolved", options->resolved,
                    "print the whole scenario after extends and --set");
  command->footer("Example: windhover check scenarios/uavde_12mm.yaml");
  command->callback([=] { *chosen = [=] { return Check(*options); }; });
}

}  // namespace windhover
