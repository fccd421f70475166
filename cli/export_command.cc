#include <iostream>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "cli/command.h"
#include "cli/dataset_scenario.h"
#include "cli/progress.h"
#include "common/config/enum_name.h"
#include "common/process/process.h"
#include "dataset/export.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string source, format, out, split = "train";
  std::vector<std::string> overrides;
  std::optional<int> frames;
  std::uint64_t seed = 1;
  ImageOptions images;
};

FlightSource SourceOf(const Options& options) {
  if (fs::is_directory(options.source)) {
    if (!options.overrides.empty()) {
      throw ConfigError("--set goes with a scenario: a run was flown as it is");
    }
    return FlightsOfRun(options.source, *ValueNamed<Split>(options.split), options.frames);
  }
  return FlightsOfDataset(
      LoadDatasetBase(options.source, options.overrides), options.seed, options.frames,
      MakeDatasetLayout(*ValueNamed<DatasetFormat>(options.format), options.out)->pair_choice());
}

// Without what changes no bit: where files go, and how many threads there were.
std::string CommandOf(const Options& options) {
  std::string command = fmt::format("windhover export {} --format {}",
                                    fs::path(options.source).filename().string(), options.format);
  for (const std::string& set : options.overrides) command += " --set " + set;
  if (options.frames) command += fmt::format(" --frames {}", *options.frames);
  if (fs::is_directory(options.source)) {
    command += " --split " + options.split;
  } else {
    command += fmt::format(" --seed {}", options.seed);
  }
  if (options.images.clean_twins) command += " --clean";
  if (options.images.dense) command += " --dense";
  return command + fmt::format(" --jpeg-quality {}", options.images.jpeg_quality);
}

int RunExport(const Options& options) {
  ExportPlan plan;
  plan.source = SourceOf(options);
  plan.format = *ValueNamed<DatasetFormat>(options.format);
  plan.images = options.images;
  plan.folder = options.out;
  plan.scenario = fs::path(options.source).filename().string();
  plan.command = CommandOf(options);
  plan.version = WINDHOVER_VERSION;
  bool is_done = false;
  {
    Progress progress(isatty(STDERR_FILENO) != 0);
    is_done = Export(plan, [&](int done, int total) {
      progress.Update(done, total);
      return !StopRequested();
    });
  }
  if (is_done) {
    fmt::print("{}\n", options.out);
    return kPass;
  }
  fmt::print(stderr, "windhover: interrupted; the same command goes on where this one was\n");
  return kInterrupted;
}

void AddOptions(CLI::App* command, Options* options) {
  command
      ->add_option("SOURCE", options->source,
                   "scenario or preset, whose data set is flown, or the folder of a run")
      ->required()
      ->check(CLI::ExistingPath);
  command->add_option("--format", options->format, "whose files to write")
      ->required()
      ->check(CLI::IsMember(NamesOf<DatasetFormat>()));
  command
      ->add_option("--out", options->out, "folder, new or empty or of the same unfinished export")
      ->required();
  command
      ->add_option("--frames", options->frames,
                   "stereo pairs in all (of a run: of each rig); default: as the scenario says")
      ->check(CLI::Range(1, 100'000'000));
  command->add_option("--seed", options->seed, "which data set of the scenario's");
  command->add_option("--split", options->split, "which part of a data set a run is")
      ->check(CLI::IsMember(NamesOf<Split>()));
  command->add_option("--set", options->overrides, "a.b.c=value, as for run")
      ->allow_extra_args(false);
  command->add_option("--jpeg-quality", options->images.jpeg_quality, "of formats with JPEG")
      ->check(CLI::Range(1, 100));
  command->add_flag("--clean", options->images.clean_twins,
                    "also every image without noise and blur, in clean/");
  command->add_flag("--dense", options->images.dense,
                    "also depth, disparity and masks of every pair, in dense/");
  command->add_option("--threads", options->images.threads, "changes no bit")
      ->check(CLI::Range(1, 256));
}

}  // namespace

void AddExportCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  options->images.threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  CLI::App* command = app.add_subcommand("export", "images and labels in other programs' formats");
  AddOptions(command, options.get());
  command->footer(
      "Example: windhover export scenarios/presets/uavde_12mm.yaml --format uavde --out uavde");
  command->callback([=] { *chosen = [=] { return RunExport(*options); }; });
}

}  // namespace windhover
