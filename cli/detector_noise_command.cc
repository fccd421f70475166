#include <algorithm>
#include <iostream>
#include <iterator>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/dataset_scenario.h"
#include "cli/progress.h"
#include "common/process/process.h"
#include "learn/detector/detector_trial.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string scenario, card;
  std::vector<std::string> overrides;
  int pairs = 1000, empty = 750;
  std::uint64_t seed = 1;
  double nearest_m = 4, farthest_m = 40;
  bool keep_card = false;
};

std::string CommandOf(const Options& options) {
  std::string command = fmt::format("windhover train detector-noise {} --card {}",
                                    fs::path(options.scenario).filename().string(),
                                    fs::path(options.card).filename().string());
  for (const std::string& set : options.overrides) command += " --set " + set;
  return command + fmt::format(" --pairs {} --empty {} --seed {} --nearest {} --farthest {}",
                               options.pairs, options.empty, options.seed, options.nearest_m,
                               options.farthest_m);
}

int FitNoise(const Options& options) {
  const Scenario base = LoadDatasetBase(options.scenario, options.overrides);
  const fs::path file = options.card;
  YoloxDetector detector(ReadDetectorCard(file), file.parent_path());
  std::vector<TriedPair> pairs;
  {
    Progress progress(isatty(STDERR_FILENO) != 0);
    const int total = options.pairs + options.empty;
    int before = 0;
    const auto on_pair = [&](int done) {
      progress.Update(before + done, total);
      return !StopRequested();
    };
    pairs = TryDetector(&detector, base,
                        HeldOutPictures(options.seed, options.nearest_m, options.farthest_m),
                        options.pairs, on_pair);
    before = options.pairs;
    auto empty = TryDetector(&detector, base, EmptyPictures(options.seed, /*most_distractors=*/0),
                             options.empty, on_pair);
    std::move(empty.begin(), empty.end(), std::back_inserter(pairs));
  }
  if (StopRequested()) return kInterrupted;
  const TrialScore score = ScoreTrial(pairs);
  std::cout << TrialText(score);
  GeometricConfig fitted;
  try {
    fitted = FitBoxNoise(ErrorSamples(pairs));
  } catch (const std::invalid_argument& error) {
    fmt::print(stderr, "windhover: error: {}\n", error.what());
    return kGateFailed;
  }
  std::cout << BoxNoiseText(fitted);
  if (!options.keep_card) PutIntoCard(options.card, CommandOf(options), score, fitted);
  return kPass;
}

}  // namespace

void AddDetectorNoiseCommand(CLI::App& train, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = train.add_subcommand(
      "detector-noise", "tries a detector on unseen pictures; fits how its boxes err");
  command->add_option("SCENARIO", options->scenario, "scenario or preset: its rig and sensor")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--card", options->card, "of the detector; gets box_noise")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_option("--pairs", options->pairs, "to draw")->check(CLI::Range(1, 1000000));
  command->add_option("--empty", options->empty, "pairs without an aircraft to draw")
      ->check(CLI::Range(0, 1000000));
  command->add_option("--seed", options->seed, "which pairs");
  command->add_option("--nearest", options->nearest_m, "target, m")->check(CLI::Range(1.0, 1e4));
  command->add_option("--farthest", options->farthest_m, "target, m")->check(CLI::Range(1.0, 1e4));
  command->add_flag("--keep-card", options->keep_card, "only print");
  command->footer(
      "Example: windhover train detector-noise scenarios/presets/uavde_12mm.yaml --card "
      "models/yolox_small.json");
  command->callback([=] { *chosen = [=] { return FitNoise(*options); }; });
}

}  // namespace windhover
