#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/command.h"
#include "common/config/enum_name.h"
#include "learn/tuple_file.h"
#include "learn/uavde_folder.h"

namespace windhover {
namespace {

struct Options {
  UavdeFolder data;
  std::string folder, format, out, boxes = "detected";
  std::vector<int> image = {1280, 720};
};

int Import(const Options& options) {
  UavdeFolder data = options.data;
  data.folder = options.folder;
  data.boxes = *ValueNamed<UavdeBoxes>(options.boxes);
  data.image_width_px = options.image[0];
  data.image_height_px = options.image[1];
  const TupleSplits tuples = ReadUavdeTexts(data);
  WriteTuples(tuples, options.out);
  fmt::print("{}: {} + {} + {} tuples\n", options.out, tuples.train.size(), tuples.val.size(),
             tuples.test.size());
  return kPass;
}

}  // namespace

void AddImportCommand(CLI::App& app, CommandAction* chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "import", "real boxes and distances as tuples for `train pcm --tuples` and `score`");
  command->add_option("DIR", options->folder, "folder that holds `data`, or is it")
      ->required()
      ->check(CLI::ExistingDirectory);
  command->add_option("--format", options->format, "whose layout")
      ->required()
      ->check(CLI::IsMember({"uavde"}));
  command->add_option("--out", options->out, "file of tuples, CSV")->required();
  command
      ->add_option("--boxes", options->boxes, "whose boxes: a detector's, or those drawn by hand")
      ->check(CLI::IsMember(NamesOf<UavdeBoxes>()));
  command->add_option("--image", options->image, "width and height that boxes are shares of, px")
      ->expected(2)
      ->check(CLI::Range(16, 8192));
  command
      ->add_option("--frame-rate-hz", options->data.frame_rate_hz,
                   "at which frames were numbered; times follow from it")
      ->check(CLI::Range(0.01, 1000.0));
  command->footer(
      "Example: windhover import --format uavde UAVDE --out real.csv\n"
      "         windhover train pcm scenarios/presets/uavde_12mm.yaml --tuples real.csv "
      "--from models/uavde_12mm.json --out models/real.json");
  command->callback([=] { *chosen = [=] { return Import(*options); }; });
}

}  // namespace windhover
