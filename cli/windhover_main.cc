// windhover: the one command a person needs.

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "common/process/process.h"

int main(int argc, char** argv) {
  using namespace windhover;
  CLI::App app("simulates swarms of UAVs that measure each other's distance with stereo cameras",
               "windhover");
  app.set_version_flag("--version", WINDHOVER_VERSION);
  app.require_subcommand(1);
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return fmt::format(
        "windhover: error: {}\nTry: {} --help\n", error.what(),
        failed->get_parent() == nullptr ? failed->get_name() : "windhover " + failed->get_name());
  });
  app.footer(
      "Exit codes: 0 pass, 1 a gate failed, 2 bad usage or scenario, 3 run invalid,\n"
      "            4 environment missing, 130 interrupted.\n"
      "Example: windhover run scenarios/ideal_geometric.yaml");
  CommandAction chosen;
  for (const auto add :
       {AddRunCommand, AddCheckCommand, AddKeysCommand, AddReplayCommand, AddScoreCommand,
        AddCompareCommand, AddSweepCommand, AddBudgetCommand, AddAdviseCommand, AddReportCommand,
        AddReproduceCommand, AddExportCommand, AddImportCommand, AddTrainCommand, AddBenchCommand,
        AddMeshInfoCommand, AddSnapshotCommand, AddDoctorCommand, AddSpyCommand}) {
    add(app, &chosen);
  }
  int exit_code = 0;
  const int status = RunProgram(app, argc, argv, [&] { exit_code = chosen(); });
  return status == 0 ? exit_code : status;
}
