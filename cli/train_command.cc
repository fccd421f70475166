#include <iostream>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/dataset_scenario.h"
#include "cli/progress.h"
#include "common/file/sha256.h"
#include "common/file/whole_file.h"
#include "common/process/process.h"
#include "learn/audit.h"
#include "learn/pcm_onnx.h"
#include "learn/recorded_tuples.h"
#include "learn/train_card.h"
#include "learn/tuple_file.h"
#include "learn/tuple_source.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string scenario, out, tuples, from, keep_tuples;
  std::string recipe = "stable";
  std::vector<std::string> overrides;
  std::optional<int> epochs, stages, width;
  std::optional<double> threshold;
  std::uint64_t seed = 1, data_seed = 1;
  int threads = 1;
  bool resume = false, all_hard = false, audit = false;
};

PcmRecipe RecipeOf(const Options& options) {
  PcmRecipe recipe = options.recipe == "paper" ? PaperRecipe() : StableRecipe();
  recipe.seed = options.seed;
  recipe.epochs = options.epochs.value_or(recipe.epochs);
  recipe.n_stages = options.stages.value_or(recipe.n_stages);
  recipe.width = options.width.value_or(recipe.width);
  recipe.threshold = options.threshold.value_or(recipe.threshold);
  recipe.all_hard = options.all_hard;
  return recipe;
}

Scenario BaseOf(const Options& options, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides = options.overrides;
  overrides.insert(overrides.end(), more.begin(), more.end());
  return LoadDatasetBase(options.scenario, std::move(overrides));
}

/// Folders of runs, instead of a scenario.
bool IsRecorded(const Options& options) { return fs::is_directory(options.scenario); }

// "flights" of "runs/flights/", too.
std::string NameOf(const fs::path& path) {
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

// Without what changes nothing: where files are, and how many threads there were.
std::string CommandOf(const Options& options) {
  std::string command = "windhover train pcm " + NameOf(options.scenario);
  for (const std::string& set : options.overrides) command += " --set " + set;
  if (!options.tuples.empty()) {
    command += " --tuples " + NameOf(options.tuples);
  } else if (!IsRecorded(options)) {
    command += fmt::format(" --data-seed {}", options.data_seed);
  }
  if (!options.from.empty()) command += " --from " + fs::path(options.from).filename().string();
  command += fmt::format(" --recipe {} --seed {}", options.recipe, options.seed);
  if (options.epochs) command += fmt::format(" --epochs {}", *options.epochs);
  if (options.stages) command += fmt::format(" --stages {}", *options.stages);
  if (options.width) command += fmt::format(" --width {}", *options.width);
  if (options.threshold) command += fmt::format(" --threshold {}", *options.threshold);
  if (options.all_hard) command += " --all-hard";
  return command;
}

// Of every file, by its name where there are some.
nlohmann::ordered_json Sha256Of(const fs::path& file_or_folder, const std::string& extension) {
  if (!fs::is_directory(file_or_folder)) return Sha256OfFile(file_or_folder);
  std::map<std::string, std::string> sums;
  for (const auto& entry : fs::recursive_directory_iterator(file_or_folder)) {
    if (entry.path().extension() != extension) continue;
    sums[fs::relative(entry.path(), file_or_folder).string()] = Sha256OfFile(entry.path());
  }
  return sums;
}

void TakeRuns(const Options& options, CardPlan* plan) {
  if (!options.overrides.empty() || !options.tuples.empty()) {
    throw ConfigError(
        fmt::format("{}: what was recorded takes no --set and no --tuples", options.scenario));
  }
  RecordedTuples recorded = ReadRecordedTuples(options.scenario);
  plan->rig = recorded.rig;
  plan->tuples = std::move(recorded.tuples);
  plan->provenance["data"] = NameOf(options.scenario);
  plan->provenance["data_sha256"] = Sha256Of(options.scenario, ".lcm");
  plan->provenance["split"] = recorded.split_by_run ? "by run" : "by time";
}

void TakeScenario(const Options& options, CardPlan* plan) {
  const Scenario base = BaseOf(options);
  plan->rig = base.rig.calibrated.ToStereoRig();
  if (options.tuples.empty()) {
    plan->tuples = DrawTuples(base, options.data_seed, options.threads);
    plan->provenance["data"] = NameOf(options.scenario);
  } else {
    plan->tuples = ReadTuples(options.tuples, plan->rig.width_px, plan->rig.height_px);
    plan->provenance["data"] = NameOf(options.tuples);
    plan->provenance["data_sha256"] = Sha256Of(options.tuples, ".npy");
  }
}

CardPlan PlanOf(const Options& options) {
  CardPlan plan;
  plan.pcm = RecipeOf(options);
  plan.joint_mlp.seed = options.seed;
  if (!options.from.empty()) plan.start = ReadCorrectionCard(fs::path(options.from));
  plan.state_file = options.out + ".state";
  plan.resume = options.resume;
  plan.provenance = {{"command", CommandOf(options)}, {"version", WINDHOVER_VERSION}};
  if (IsRecorded(options)) {
    TakeRuns(options, &plan);
  } else {
    TakeScenario(options, &plan);
  }
  return plan;
}

// The card names the models by what their names add to its own: it does not know where it is.
void WriteModels(const Options& options, CorrectionCard* card) {
  auto& named = card->provenance["onnx"];
  for (const NamedModel& network : PcmOnnx(*card->pcm)) {
    const std::string extension = network.name + ".onnx";
    const fs::path file = fs::path(options.out).replace_extension(extension);
    ReplaceFile(file, network.model);
    named[extension] = Sha256OfFile(file);
  }
}

void Write(const Options& options, TrainedCard trained) {
  WriteModels(options, &trained.card);
  ReplaceFile(options.out, CorrectionCardText(trained.card));
  fs::path curve = options.out;
  ReplaceFile(curve.replace_extension(".svg"), CurveSvg(trained.curve));
  std::cout << ScoresText(trained.card) << options.out << '\n';
}

int AuditTraining(const Options& options) {
  if (IsRecorded(options)) {
    throw ConfigError(options.scenario + ": an audit draws data: it takes a scenario");
  }
  const StereoRig rig = BaseOf(options).rig.calibrated.ToStereoRig();
  const auto draw = [&](const std::vector<std::string>& overrides) {
    return DrawTuples(BaseOf(options, overrides), options.data_seed, options.threads);
  };
  const std::string text = AuditText(Audit(rig, RecipeOf(options), draw));
  ReplaceFile(options.out, text);
  std::cout << text;
  return kPass;
}

int Train(const Options& options) {
  if (options.audit) return AuditTraining(options);
  const CardPlan plan = PlanOf(options);
  if (!options.keep_tuples.empty()) WriteTuples(plan.tuples, options.keep_tuples);
  if (fs::path(options.out).has_parent_path()) {
    fs::create_directories(fs::path(options.out).parent_path());
  }
  TrainedCard trained;
  {
    Progress progress(isatty(STDERR_FILENO) != 0);
    trained = TrainCard(plan, [&](int done, int total) {
      progress.Update(done, total);
      return !StopRequested();
    });
  }
  if (trained.end == TrainingEnd::kInterrupted) {
    fmt::print(stderr, "windhover: interrupted; go on with --resume (state in {})\n",
               plan.state_file.string());
    return kInterrupted;
  }
  Write(options, trained);
  std::error_code ignored;
  fs::remove(plan.state_file, ignored);
  if (trained.end == TrainingEnd::kFinished) return kPass;
  fmt::print(stderr, "windhover: error: training diverged; {} has the best before that\n",
             options.out);
  return kGateFailed;
}

void AddDataOptions(CLI::App* command, Options* options) {
  command
      ->add_option("SCENARIO", options->scenario,
                   "scenario or preset: its rig, and the data set to draw; or the folder of a run, "
                   "or of some")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_option("--data-seed", options->data_seed, "which data set to draw");
  command
      ->add_option("--tuples", options->tuples,
                   "take these tuples instead: CSV, UAVDE's .npy, or a folder with its "
                   "train.npy, val.npy and test.npy")
      ->check(CLI::ExistingPath);
  command->add_option("--keep-tuples", options->keep_tuples, "write the tuples to this file");
  command->add_option("--threads", options->threads, "of drawing; changes no bit")
      ->check(CLI::Range(1, 256));
}

void AddRecipeOptions(CLI::App* command, Options* options) {
  command->add_option("--recipe", options->recipe, "paper or stable")
      ->check(CLI::IsMember({"paper", "stable"}));
  command->add_option("--epochs", options->epochs, "instead of the recipe's")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--stages", options->stages, "corrections at most")->check(CLI::Range(1, 8));
  command->add_option("--width", options->width, "of the mixers, 4 or 96")
      ->check(CLI::IsMember({4, 96}));
  command->add_option("--threshold", options->threshold, "T: errors above make a sample hard")
      ->check(CLI::Range(0.0, 10.0));
  command->add_flag("--all-hard", options->all_hard, "further stages learn from all (DIC*)");
  command->add_option("--seed", options->seed, "of initial weights and shuffling");
  command->add_option("--from", options->from, "card to go on from (fine-tuning)")
      ->check(CLI::ExistingFile);
}

}  // namespace

void AddTrainCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* train = app.add_subcommand("train", "learns detectors, and corrections of a rig's distances");
  train->require_subcommand(1);
  CLI::App* pcm = train->add_subcommand(
      "pcm", "position corrections (PCM, DIC) and a joint MLP, into one card");
  AddDataOptions(pcm, options.get());
  AddRecipeOptions(pcm, options.get());
  pcm->add_option("--out", options->out, "card to write (.json); curve and ONNX files go beside it")
      ->required();
  pcm->add_flag("--resume", options->resume, "go on with an interrupted training");
  pcm->add_flag("--audit", options->audit, "instead, say what a correction learns here (text)")
      ->excludes("--tuples");
  const char* example =
      "Example: windhover train pcm scenarios/presets/uavde_12mm.yaml --out card.json";
  AddTrainDetectorCommand(*train, chosen);
  train->footer(example);
  pcm->footer(example);
  AddDetectorNoiseCommand(*train, chosen);
  pcm->callback([=] { *chosen = [=] { return Train(*options); }; });
}

}  // namespace windhover
