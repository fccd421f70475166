// windhover-train-detector: what `windhover train detector` starts; the only program with libtorch.

#include <chrono>
#include <iostream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/dataset_scenario.h"
#include "cli/progress.h"
#include "cli/train_detector_options.h"
#include "common/file/sha256.h"
#include "common/file/whole_file.h"
#include "common/process/process.h"
#include "learn/detector/labelled_folder.h"
#include "learn/detector/picture_samples.h"
#include "learn/detector/train_detector.h"
#include "network/detector_card.h"
#include "network/network_file.h"
#include "network/network_onnx.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kShareBesideMistakes = 0.5;  // Of samples that show an aircraft.
constexpr int kSettlingSteps = 150;  // A running mean keeps 0.97 a batch: 1 % of what it was.

std::string NameOf(const std::string& file) { return fs::path(file).filename().string(); }

// "own" of "pictures/own/", too.
std::string FolderNameOf(const fs::path& folder) {
  return (folder.has_filename() ? folder : folder.parent_path()).filename().string();
}

// Without what changes nothing: where files are, how many threads there were, and stops.
std::string CommandOf(const TrainDetectorOptions& options) {
  const DetectorRecipe& recipe = options.recipe;
  std::string command = fmt::format(
      "windhover train detector {} --network {} --steps {} --batch {} --crop {} "
      "--rate {} --seed {} --data-seed {}",
      NameOf(options.scenario), recipe.network, recipe.steps, options.batch, options.crop_px,
      recipe.rate, recipe.seed, options.data_seed);
  for (const std::string& file : options.panoramas) command += " --panorama " + NameOf(file);
  for (const std::string& file : options.photos) command += " --photo " + NameOf(file);
  if (!options.from.empty()) command += " --from " + NameOf(options.from);
  if (!options.first.empty()) command += " --first " + NameOf(options.first);
  if (!options.second.empty()) command += " --second " + NameOf(options.second);
  if (!options.labelled.empty()) {
    command += fmt::format(" --labelled {} --labelled-share {}", FolderNameOf(options.labelled),
                           options.labelled_share);
  }
  return command;
}

PictureConfig PicturesOf(const TrainDetectorOptions& options) {
  PictureConfig pictures;
  pictures.seed = options.data_seed;
  const auto add = [&](EnvironmentType type, const std::vector<std::string>& files) {
    for (const std::string& file : files) {
      EnvironmentConfig& background = pictures.backgrounds.emplace_back();
      background.type = type;
      background.file = {file, fs::absolute(file).string(), file};
    }
  };
  add(EnvironmentType::kPanorama, options.panoramas);
  add(EnvironmentType::kPhoto, options.photos);
  return pictures;
}

std::unique_ptr<DetectorSampleSource> DrawnSource(const TrainDetectorOptions& options,
                                                  ReplayConfig replay) {
  const Scenario base = LoadDatasetBase(options.scenario, {});
  if (!IsRefiner(options)) return MakeDetectionSource(base, PicturesOf(options), replay);
  FindPlaces find;
  if (!options.first.empty()) {
    find = PlacesFoundBy(ReadWeights(ReadDetectorCard(options.first).detector,
                                     fs::path(options.first).parent_path()));
    replay.positive_share = kShareBesideMistakes;
  }
  return MakeRefinementSource(base, PicturesOf(options), replay, std::move(find));
}

std::unique_ptr<DetectorSampleSource> SourceOf(const TrainDetectorOptions& options,
                                               const std::vector<LabelledFile>& labelled) {
  ReplayConfig replay{.seed = options.data_seed, .batch = options.batch};
  if (!IsRefiner(options)) {
    replay.size = {options.crop_px, options.crop_px};
    replay.whole_every = options.whole_every;
    replay.whole_batch = options.batch;  // Half of it at least 16, or libtorch takes a slower way.
    replay.whole_from = options.recipe.steps;
  }
  if (labelled.empty()) return DrawnSource(options, replay);
  auto own = MakeFolderSource(labelled, IsRefiner(options), replay);
  if (options.labelled_share >= 1) return own;
  return Mixed(std::move(own), DrawnSource(options, replay), options.labelled_share);
}

nlohmann::ordered_json DataOf(const TrainDetectorOptions& options) {
  nlohmann::ordered_json data = {{"scenario", NameOf(options.scenario)},
                                 {"scenario_sha256", Sha256OfFile(options.scenario)},
                                 {"seed", options.data_seed},
                                 {"batch", options.batch}};
  data["crop_px"] = IsRefiner(options) ? kRefinementSide_px : options.crop_px;
  if (!IsRefiner(options)) data["whole_every"] = options.whole_every;
  for (const auto* files : {&options.panoramas, &options.photos}) {
    for (const std::string& file : *files) data["backgrounds"].push_back(Sha256OfFile(file));
  }
  if (!options.first.empty()) {
    data["first_sha256"] = ReadDetectorCard(options.first).detector.sha256;
  }
  if (!options.from.empty()) data["from_sha256"] = Sha256OfFile(options.from);
  if (!options.labelled.empty()) {
    data["labelled"] = {{"folder", FolderNameOf(options.labelled)},
                        {"sha256", Sha256OfFolder(options.labelled)},
                        {"share", options.labelled_share}};
  }
  return data;
}

// What was written has the convolutions in the order of the table.
NetworkWeights WeightsFor(const LayerTable& table, const NetworkModel& model) {
  NetworkWeights weights;
  std::size_t next = 0;
  for (const Layer& layer : table.layers) {
    ConvWeights& own = weights.layers.emplace_back();
    if (layer.kind != LayerKind::kConv) continue;
    while (next < model.weights.layers.size() && model.weights.layers[next].weight.empty()) ++next;
    if (next < model.weights.layers.size()) own = model.weights.layers[next++];
  }
  return weights;
}

DetectorPlan PlanOf(const TrainDetectorOptions& options) {
  DetectorPlan plan;
  plan.recipe = options.recipe;
  plan.threads = options.threads;
  plan.state_file = options.state.empty() ? options.out + ".state" : options.state;
  plan.resume = options.resume;
  plan.data = DataOf(options);
  std::vector<LabelledFile> labelled;
  if (!options.labelled.empty()) {
    labelled = ReadLabelledFolder(options.labelled);
    plan.data["labelled"]["pictures"] = labelled.size();
  }
  // Crops show more aircraft than whole pictures, and larger ones: their statistics are others.
  if (!IsRefiner(options) && options.from.empty()) plan.settling_steps = kSettlingSteps;
  plan.make_source = [options, labelled] { return SourceOf(options, labelled); };
  if (!options.from.empty()) {
    const LayerTable table = MakeYolox(options.recipe.network).table;
    plan.start = WeightsFor(table, ReadNetwork(options.from));
    try {
      CheckWeights(table, *plan.start);
    } catch (const std::invalid_argument& error) {
      throw ConfigError(
          fmt::format("{}: must be a {} ({})", options.from, table.name, error.what()));
    }
  }
  return plan;
}

// Another second look has other scores and errs in another way.
void GiveSecondStage(const DetectorCard& second, const std::string& command, DetectorCard* first) {
  first->refiner = second.detector;
  first->refiner_margin = kRefinementMargin;
  first->box_noise = nullptr;
  first->provenance.erase("box_noise");
  first->provenance.erase("min_score");
  first->provenance["refiner"] = command;
}

void PutIntoFirst(const TrainDetectorOptions& options, const DetectorCard& refiner) {
  DetectorCard first = ReadDetectorCard(options.first);
  GiveSecondStage(refiner, CommandOf(options), &first);
  ReplaceFile(options.first, DetectorCardText(first));
}

void Write(const TrainDetectorOptions& options, const DetectorPlan& plan,
           const TrainedDetector& trained) {
  const YoloxNetwork network = MakeYolox(options.recipe.network);
  const fs::path onnx = fs::path(options.out).replace_extension(".onnx");
  ReplaceFile(onnx, NetworkOnnx(network.table, trained.weights, network.height, network.width));
  DetectorCard card;
  card.network = options.recipe.network;
  card.detector = {onnx.filename().string(), Sha256OfFile(onnx)};
  card.provenance = {{"command", CommandOf(options)},
                     {"version", WINDHOVER_VERSION},
                     {"recipe", ToJson(options.recipe)},
                     {"data", plan.data},
                     {"steps_done", trained.steps_done},
                     {"pictures_seen", std::int64_t{trained.steps_done} * options.batch},
                     {"input_px", {network.width, network.height}},
                     {"parameters", ParameterCount(network.table)}};
  if (!options.second.empty()) {
    const DetectorCard second = ReadDetectorCard(options.second);
    GiveSecondStage(second, second.provenance.value("command", ""), &card);
  }
  ReplaceFile(options.out, DetectorCardText(card));
  if (!options.first.empty()) PutIntoFirst(options, card);
  fs::path curve = options.out;
  ReplaceFile(curve.replace_extension(".svg"), DetectorCurveSvg(trained.curve));
  std::cout << options.out << '\n';
}

TrainedDetector Train(const TrainDetectorOptions& options, const DetectorPlan& plan) {
  const Clock::time_point start = Clock::now();
  const auto is_late = [&] {
    return options.minutes &&
           Clock::now() - start > std::chrono::duration<double>(*options.minutes * 60);
  };
  Progress progress(isatty(STDERR_FILENO) != 0);
  return TrainDetector(plan, [&](int done, int total) {
    progress.Update(done, total);
    return !StopRequested() && !is_late();
  });
}

int Main(const TrainDetectorOptions& options) {
  CheckTrainDetectorOptions(options);
  const DetectorPlan plan = PlanOf(options);
  if (fs::path(options.out).has_parent_path()) {
    fs::create_directories(fs::path(options.out).parent_path());
  }
  const TrainedDetector trained = Train(options, plan);
  Write(options, plan, trained);
  if (trained.end == DetectorTrainingEnd::kInterrupted) {
    fmt::print(stderr,
               "windhover: stopped after {} of {} steps; go on with --resume (state in {})\n",
               trained.steps_done, plan.recipe.steps, plan.state_file.string());
    return kInterrupted;
  }
  if (trained.end == DetectorTrainingEnd::kFinished) return kPass;
  fmt::print(stderr, "windhover: error: training diverged after {} steps\n", trained.steps_done);
  return kGateFailed;
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  windhover::TrainDetectorOptions options;
  CLI::App app("trains a detector on rendered pictures", "windhover train detector");
  windhover::AddTrainDetectorOptions(&app, &options);
  int exit_code = 0;
  const int status =
      windhover::RunProgram(app, argc, argv, [&] { exit_code = windhover::Main(options); });
  return status == 0 ? exit_code : status;
}
