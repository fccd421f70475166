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
  int pairs = 1000, empty = 1500;
  std::uint64_t seed = 1;
  double nearest_m = 4, farthest_m = 40;
  bool keep_card = false, choose_score = false;
};

constexpr double kLeastScore = 0.05;  // Of which least scores are chosen.

std::string CommandOf(const Options& options) {
  std::string command = fmt::format("windhover train detector-noise {} --card {}",
                                    fs::path(options.scenario).filename().string(),
                                    fs::path(options.card).filename().string());
  for (const std::string& set : options.overrides) command += " --set " + set;
  if (options.choose_score) command += " --choose-score";
  return command + fmt::format(" --pairs {} --empty {} --seed {} --nearest {} --farthest {}",
                               options.pairs, options.empty, options.seed, options.nearest_m,
                               options.farthest_m);
}

/// Pictures with a target, then as many empty ones as asked for.
std::vector<TriedPair> Try(const Options& options, const DetectorCard& card) {
  const Scenario base = LoadDatasetBase(options.scenario, options.overrides);
  YoloxDetector detector(card, fs::path(options.card).parent_path());
  Progress progress(isatty(STDERR_FILENO) != 0);
  int before = 0;
  const auto on_pair = [&](int done) {
    progress.Update(before + done, options.pairs + options.empty);
    return !StopRequested();
  };
  auto pairs = TryDetector(&detector, base,
                           HeldOutPictures(options.seed, options.nearest_m, options.farthest_m),
                           options.pairs, on_pair);
  before = options.pairs;
  auto empty = TryDetector(&detector, base, EmptyPictures(options.seed, /*most_distractors=*/0),
                           options.empty, on_pair);
  std::move(empty.begin(), empty.end(), std::back_inserter(pairs));
  return pairs;
}

int FitNoise(const Options& options) {
  const auto pairs = Try(options, ReadDetectorCard(options.card));
  if (StopRequested()) return kInterrupted;
  const TrialScore score = ScoreTrial(pairs);
  std::cout << TrialText(score);
  const GeometricConfig fitted = FitBoxNoise(ErrorSamples(pairs));
  std::cout << BoxNoiseText(fitted);
  if (!options.keep_card) PutIntoCard(options.card, CommandOf(options), score, fitted);
  return kPass;
}

int ChooseScore(const Options& options) {
  DetectorCard card = ReadDetectorCard(options.card);
  card.min_score = kLeastScore;
  const auto pairs = Try(options, card);
  if (StopRequested()) return kInterrupted;
  const auto choices = ScoreChoices(pairs);
  std::cout << ScoreChoicesText(choices);
  const double min_score = QuietScore(choices);
  fmt::print("min_score: {:.2f}\n", min_score);
  if (!options.keep_card) PutMinScoreIntoCard(options.card, CommandOf(options), min_score);
  return kPass;
}

// What was learned may not do, which is no mistake of whoever asks.
int Judge(const Options& options) try {
  return options.choose_score ? ChooseScore(options) : FitNoise(options);
} catch (const std::invalid_argument& error) {
  fmt::print(stderr, "windhover: error: {}\n", error.what());
  return kGateFailed;
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
  command->add_flag("--choose-score", options->choose_score,
                    "only find the least score that finds nothing in empty pairs");
  command->add_flag("--keep-card", options->keep_card, "only print");
  command->footer(
      "Example: windhover train detector-noise scenarios/presets/uavde_12mm.yaml --card "
      "models/yolox_small.json");
  command->callback([=] { *chosen = [=] { return Judge(*options); }; });
}

}  // namespace windhover
