#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "cli/dataset_scenario.h"
#include "cli/verdict.h"
#include "common/config/enum_name.h"
#include "eval/evaluation.h"
#include "eval/score_json.h"
#include "learn/tuple_file.h"
#include "learn/tuple_score.h"

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

struct ScoreOptions {
  std::string source, scenario;
  std::optional<std::string> split;
  std::vector<std::string> overrides;
  bool as_json = false;
};

std::vector<StereoTuple> ChosenTuples(const ScoreOptions& options, const AircraftConfig& config) {
  const auto [width_px, height_px] = config.rig.image;
  const TupleSplits tuples = ReadTuples(options.source, width_px, height_px);
  const std::string split = options.split.value_or(NameOf(Split::kTest));
  return split == NameOf(Split::kTrain) ? tuples.train
         : split == NameOf(Split::kVal) ? tuples.val
                                        : tuples.test;
}

int ScoreTupleFile(const ScoreOptions& options) {
  const AircraftConfig config =
      LoadScenarioOrPreset(options.scenario, options.overrides).ForAircraft();
  const nlohmann::ordered_json score = {
      {"scenario", fs::path(options.scenario).filename().string()},
      {"tuples", fs::path(options.source).filename().string()},
      {"split", options.split.value_or(NameOf(Split::kTest))},
      {"methods", MethodsJson(ScoreTuples(ChosenTuples(options, config), config))}};
  std::cout << (options.as_json ? score.dump(2) + "\n" : MethodsTable(score));
  return kPass;
}

int ScoreSource(const ScoreOptions& options) {
  if (!options.scenario.empty()) return ScoreTupleFile(options);
  return Score(options.source, options.as_json);
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
  auto options = std::make_shared<ScoreOptions>();
  CLI::App* command = app.add_subcommand(
      "score", "scores a run again, from its log alone, or recorded tuples (windhover import)");
  command->add_option("RUN", options->source, "run directory, log, or tuples")->required();
  CLI::Option* scenario =
      command
          ->add_option("--scenario", options->scenario,
                       "RUN has tuples, of this scenario's rig: score its estimator.methods")
          ->check(CLI::ExistingFile);
  command->add_option("--split", options->split, "which tuples; default: test")
      ->check(CLI::IsMember(NamesOf<Split>()))
      ->needs(scenario);
  command->add_option("--set", options->overrides, "a.b.c=value, of the scenario")
      ->allow_extra_args(false)
      ->needs(scenario);
  command->add_flag("--json", options->as_json, "print score.json instead of a table");
  command->footer(
      "Example: windhover score runs/ideal_geometric-1\n"
      "         windhover score real.csv --scenario scenarios/presets/uavde_12mm.yaml");
  command->callback([=] { *chosen = [=] { return ScoreSource(*options); }; });
}

void AddReportCommand(CLI::App& app, CommandAction* chosen) {
  auto run = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("report", "writes report.html again, from the log alone");
  command->add_option("RUN", *run, "run directory, or a log")->required();
  command->footer("Example: windhover report runs/ideal_geometric-1");
  command->callback([=] { *chosen = [=] { return Report(*run); }; });
}

}  // namespace windhover
