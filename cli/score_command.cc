#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/verdict.h"
#include "eval/evaluation.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

// Where results belong: a run's folder, or the folder that a bare log lies in.
fs::path FolderOf(const fs::path& run_dir_or_log) {
  if (fs::is_directory(run_dir_or_log)) return run_dir_or_log;
  return run_dir_or_log.has_parent_path() ? run_dir_or_log.parent_path() : fs::path(".");
}

int Score(const fs::path& run, bool as_json) {
  const Evaluation evaluation = Evaluate(run);
  WriteScoreFiles(evaluation, FolderOf(run));
  if (as_json) {
    std::cout << evaluation.score.dump(2) << '\n';
  } else {
    std::cout << VerdictTable(evaluation.score);
  }
  return ExitCodeOf(evaluation.verdict);
}

int Report(const fs::path& run) {
  const Evaluation evaluation = Evaluate(run);
  const fs::path folder = FolderOf(run);
  WriteReport(evaluation, folder);
  fmt::print("{}\n", (folder / "report.html").string());
  return kPass;
}

}  // namespace

void AddScoreCommand(CLI::App& app, CommandAction* chosen) {
  struct Options {
    std::string run;
    bool as_json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("score", "scores a run again, from its log alone");
  command->add_option("RUN", options->run, "run directory, or a log")->required();
  command->add_flag("--json", options->as_json, "print score.json instead of a table");
  command->footer("Example: windhover score runs/ideal_geometric-1");
  command->callback([=] { *chosen = [=] { return Score(options->run, options->as_json); }; });
}

void AddReportCommand(CLI::App& app, CommandAction* chosen) {
  auto run = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "writes report.html again, from the log alone");
  command->add_option("RUN", *run, "run directory, or a log")->required();
  command->footer("Example: windhover report runs/ideal_geometric-1");
  command->callback([=] { *chosen = [=] { return Report(*run); }; });
}

}  // namespace windhover
