#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/rig_advice.h"

namespace windhover {
namespace {

struct Options {
  std::string file;
  bool as_json = false;
};

constexpr std::size_t kMostRows = 40;

void PrintTable(const AdviceRequest& request, const std::vector<RigAdvice>& rigs) {
  fmt::print("Abs Rel of at most {:g} at {:g} m. {} rigs, the least error first:\n\n",
             request.require.abs_rel, request.require.distance_m, rigs.size());
  fmt::print("{:<5} {:>11} {:>10} {:>7}  rig\n", "", "closed form", "simulated", "view");
  for (std::size_t i = 0; i < std::min(rigs.size(), kMostRows); ++i) {
    const RigAdvice& rig = rigs[i];
    fmt::print("{:<5} {:>10.4f}{} {:>10} {:>6.1f}°  {}\n", Meets(request, rig) ? "meets" : "",
               rig.abs_rel, rig.is_small ? " " : "*",
               rig.is_simulated ? fmt::format("{:.4f}", rig.simulated_abs_rel) : "",
               rig.field_of_view_deg, request.rigs.Describe(rig.point));
  }
  if (rigs.size() > kMostRows) fmt::print("… and {} more: --json\n", rigs.size() - kMostRows);
  fmt::print("\n*: beyond first order, where only the simulation counts. view: across a camera.\n");
}

int RunAdvise(const Options& options) {
  const AdviceRequest request = LoadAdviceRequest(options.file);
  const std::vector<RigAdvice> rigs = Advise(request);
  if (options.as_json) {
    std::cout << AdviceJson(request, rigs).dump(2) << '\n';
  } else {
    PrintTable(request, rigs);
  }
  const bool is_met = std::any_of(rigs.begin(), rigs.end(),
                                  [&](const RigAdvice& rig) { return Meets(request, rig); });
  return is_met ? kPass : kGateFailed;
}

}  // namespace

void AddAdviseCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("advise", "which rig would meet a requirement");
  command->add_option("REQUIREMENT", options->file, "requirement file")->required();
  command->add_flag("--json", options->as_json, "print all rigs as JSON");
  command->footer("Example: windhover advise scenarios/sweeps/requirement.yaml");
  command->callback([=] { *chosen = [=] { return RunAdvise(*options); }; });
}

}  // namespace windhover
