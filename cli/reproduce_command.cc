#include <algorithm>
#include <fstream>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/progress.h"
#include "cli/reproduce_learned.h"
#include "cli/reproduce_targets.h"
#include "cli/tool.h"
#include "common/config/fields.h"
#include "common/file/whole_file.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char *kResources = "resources", *kPretraining = "pretraining";

struct Options {
  std::vector<std::string> tables;
  std::string out, detector = std::string(WINDHOVER_SCENARIOS_DIR) + "/../models/yolox_small.json";
  int n_seeds = 0, n_training_seeds = 0;
  bool quick = false, full = false;
};

std::vector<std::string> Chosen(const std::vector<std::string>& names,
                                const std::vector<ReproducedTable>& tables) {
  std::vector<std::string> known;
  for (const ReproducedTable& table : tables) known.push_back(table.name);
  known.insert(known.end() - 2, kResources);
  known.push_back(kPretraining);
  if (names.empty() || names == std::vector<std::string>{"all"}) return known;
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw ConfigError(
          fmt::format("TABLE must be one of {} (found '{}')", fmt::join(known, ", "), name));
    }
  }
  return names;
}

void TryUnseenTargets(const Options& given, const ReproducedTable& table, Effort effort,
                      const ReproduceOptions& options, Json* made) {
  UnseenTargetsPlan plan = UnseenTargetsOf(effort, table, options);
  plan.detector = given.detector;
  plan.folder = fs::path(given.out) / "cards";
  plan.train = [](const std::vector<std::string>& arguments) {
    std::vector<std::string> words = {OwnProgram("windhover-train-detector").string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return RunTool(words);
  };
  AddUnseenTargets(plan, options, made);
}

Json Made(const std::string& name, const std::vector<ReproducedTable>& tables, const Options& given,
          Effort effort, const ReproduceOptions& options) {
  if (name == kResources) return ReproduceResources(options);
  if (name == kPretraining) {
    return ReproducePretraining(PretrainingOf(effort, options.scenarios), options);
  }
  const auto table = std::find_if(tables.begin(), tables.end(),
                                  [&](const ReproducedTable& one) { return one.name == name; });
  Json made = Reproduce(*table, options);
  // With a shorter training its verdicts would be about that.
  if (name == "audits") AddLearnedAudits(StableRecipe(), options, &made);
  if (name == "targets") TryUnseenTargets(given, *table, effort, options, &made);
  return made;
}

/// How many data sets and trainings, where nobody says: pre-training is about intervals, and a
/// single data set has none.
void ChooseSeeds(const Options& given, const std::string& name, ReproduceOptions* options) {
  const bool is_small = given.quick && name != kPretraining;
  options->n_seeds = given.n_seeds > 0 ? given.n_seeds : is_small ? 1 : 3;
  options->n_training_seeds = given.n_training_seeds > 0 ? given.n_training_seeds
                              : is_small                 ? 1
                                                         : 2;
}

int ReproduceAll(const Options& given) {
  const Effort effort = given.quick ? Effort::kQuick : Effort::kFull;
  const std::vector<ReproducedTable> tables = ReproducedTables(effort);
  const std::vector<std::string> names = Chosen(given.tables, tables);
  const fs::path out(given.out), cards_dir = out / "cards";
  fs::create_directories(cards_dir);
  ReproduceOptions options;
  options.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.scenarios = WINDHOVER_SCENARIOS_DIR;
  const ReproducedRow learned_on{.method = "", .preset = "uavde_12mm"};
  CardShelf cards(cards_dir, BaseOf(learned_on, options.scenarios), options.threads);
  options.cards = &cards;
  std::vector<Json> made;
  for (const std::string& name : names) {
    Progress progress(isatty(STDERR_FILENO) != 0);
    options.on_step = [&](int done, int total) { progress.Update(done, total); };
    ChooseSeeds(given, name, &options);
    made.push_back(Made(name, tables, given, effort, options));
    ReplaceFile(out / (name + ".json"), made.back().dump(2) + "\n");
    std::cout << '\n' << ReproducedText(made.back()) << std::flush;
  }
  ReplaceFile(out / "report.html", ReproducedPage(made));
  std::cout << '\n' << (out / "report.html").string() << '\n';
  return kPass;
}

}  // namespace

void AddReproduceCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reproduce", "the paper's tables, ours beside theirs");
  command->add_option("TABLE", options->tables,
                      "comparison, components, corrections, threshold, hard_samples, lenses, "
                      "targets, resources, calibration, audits, pretraining; default all");
  command->add_option("--out", options->out, "folder for TABLE.json, report.html and cards/")
      ->required();
  command->add_option("--seeds", options->n_seeds, "data sets to make of each row")
      ->check(CLI::Range(1, 1000));
  command->add_option("--training-seeds", options->n_training_seeds, "trainings on each data set")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--detector", options->detector,
                   "card that `targets` tries on aircraft it never learned from; "
                   "models/yolox_small.json")
      ->check(CLI::ExistingFile);
  CLI::Option* quick =
      command->add_flag("--quick", options->quick, "one data set and short trainings: for CI");
  command->add_flag("--full", options->full, "three data sets, two trainings on each; the default")
      ->excludes(quick);
  command->footer("Example: windhover reproduce components lenses --quick --out reproduced");
  command->callback([=] { *chosen = [=] { return ReproduceAll(*options); }; });
}

}  // namespace windhover
