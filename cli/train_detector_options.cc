#include "cli/train_detector_options.h"

#include <filesystem>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "network/detector_card.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

// A card names its weights beside it.
void CheckBeside(const std::string& option, const std::string& card, const std::string& out) {
  const fs::path folder = fs::weakly_canonical(fs::absolute(out).parent_path());
  if (folder == fs::canonical(fs::absolute(card).parent_path())) return;
  throw ConfigError(fmt::format("{}: must be in the folder of --out (found {})", option, card));
}

void AddRecipeOptions(CLI::App* app, TrainDetectorOptions* options) {
  DetectorRecipe& recipe = options->recipe;
  app->add_option("--network", recipe.network, "which one")->check(CLI::IsMember(kYoloxNetworks));
  app->add_option("--steps", recipe.steps, "batches to learn")->check(CLI::Range(1, 10000000));
  app->add_option("--batch", options->batch, "pictures in each")->check(CLI::Range(1, 1024));
  app->add_option("--crop", options->crop_px, "side of the training pictures (px of 352 x 192)")
      ->check(CLI::IsMember({64, 96, 128, 160, 192}));
  app->add_option("--whole-every", options->whole_every,
                  "steps from one that learns whole pictures to the next; 0: none")
      ->check(CLI::Range(0, 1000000));
  app->add_option("--rate", recipe.rate, "the largest")->check(CLI::Range(1e-7, 1.0));
  app->add_option("--seed", recipe.seed, "of initial weights");
  app->add_option("--from", options->from, ".onnx file to go on from (fine-tuning)")
      ->check(CLI::ExistingFile);
  CLI::Option* labelled =
      app->add_option("--labelled", options->labelled,
                      "folder of pictures to learn from, too, as `export --format yolo` writes it")
          ->check(CLI::ExistingDirectory);
  app->add_option("--labelled-share", options->labelled_share, "of each batch; 1: nothing else")
      ->check(CLI::Range(0.01, 1.0))
      ->needs(labelled);
  app->add_option("--threads", options->threads, "1 or 2 of learning; changes no bit")
      ->check(CLI::Range(1, 256));
}

}  // namespace

bool IsRefiner(const TrainDetectorOptions& options) {
  return options.recipe.network == "yolox_refine";
}

void CheckTrainDetectorOptions(const TrainDetectorOptions& options) {
  const std::string& network = options.recipe.network;
  if (!options.first.empty()) {
    if (!IsRefiner(options)) {
      throw ConfigError(
          fmt::format("--first: must go with --network yolox_refine (found {})", network));
    }
    CheckBeside("--first", options.first, options.out);
  }
  if (options.second.empty()) return;
  if (IsRefiner(options)) {
    throw ConfigError(fmt::format("--second: must go with a first network (found {})", network));
  }
  CheckBeside("--second", options.second, options.out);
  const std::string second = ReadDetectorCard(options.second).network;
  if (second == "yolox_refine") return;
  throw ConfigError(fmt::format("--second: must be the card of a yolox_refine (found {})", second));
}

void AddTrainDetectorOptions(CLI::App* app, TrainDetectorOptions* options) {
  app->add_option("SCENARIO", options->scenario, "scenario or preset whose rig takes the pictures")
      ->check(CLI::ExistingFile);
  app->add_option("--out", options->out, "card to write (.json); .onnx and curve go beside it")
      ->required();
  app->add_option("--data-seed", options->data_seed, "which pictures");
  app->add_option("--panorama", options->panoramas, "background besides the drawn ones")
      ->check(CLI::ExistingFile);
  app->add_option("--photo", options->photos, "background besides the drawn ones")
      ->check(CLI::ExistingFile);
  app->add_option("--first", options->first,
                  "for yolox_refine: card beside --out of the network before it, whose mistakes it "
                  "learns from, too, and whose second stage it becomes")
      ->check(CLI::ExistingFile);
  app->add_option("--second", options->second,
                  "for others: card beside --out of a trained yolox_refine as second stage")
      ->check(CLI::ExistingFile);
  app->add_option("--state", options->state, "where an unfinished training is kept; OUT.state");
  app->add_option("--minutes", options->minutes, "stop after so many; go on with --resume")
      ->check(CLI::PositiveNumber);
  app->add_flag("--resume", options->resume, "go on with an unfinished training");
  AddRecipeOptions(app, options);
  app->footer(
      "Example: windhover train detector --network yolox_small --steps 20000 --threads 2 "
      "--out models/yolox_small.json");
}

}  // namespace windhover
