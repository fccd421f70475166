#include "network/detector_card.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/card/card_node.h"
#include "common/file/sha256.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "windhover-detector";
constexpr std::uintmax_t kMaxBytes = 1 << 20;
constexpr int kBoxChannels = 6;

DetectorCard::Weights ReadWeightsNode(const CardNode& node) {
  DetectorCard::Weights weights{node["onnx"].Text(), node["sha256"].Text()};
  if (std::filesystem::path(weights.onnx).filename() != weights.onnx) {
    node["onnx"].MustBe("the name of a file beside the card", "'" + weights.onnx + "'");
  }
  if (weights.sha256.size() != 64) node["sha256"].MustBe("64 digits", "'" + weights.sha256 + "'");
  return weights;
}

void CheckGivesBoxes(const NetworkModel& model, const std::string& name) {
  const auto shapes = ShapesOf(model.table, model.height, model.width);
  for (const int output : model.table.outputs) {
    const LayerShape& shape = shapes[static_cast<std::size_t>(output)];
    const bool fits = shape.channels == kBoxChannels && model.height % shape.height == 0 &&
                      model.width % shape.width == 0 &&
                      model.height / shape.height == model.width / shape.width;
    if (fits) continue;
    throw ConfigError(fmt::format(
        "{}: output {}: must be {} numbers for each cell of a grid (found {} x {} x {})", name,
        model.table.layers[static_cast<std::size_t>(output)].name, kBoxChannels, shape.channels,
        shape.height, shape.width));
  }
}

}  // namespace

std::string DetectorCardText(const DetectorCard& card) {
  Json json = {{"format", kFormat},
               {"version", 1},
               {"network", card.network},
               {"detector",
                {{"onnx", card.detector.onnx},
                 {"sha256", card.detector.sha256},
                 {"min_score", card.min_score}}}};
  if (card.refiner) {
    json["refiner"] = {{"onnx", card.refiner->onnx},
                       {"sha256", card.refiner->sha256},
                       {"margin", card.refiner_margin}};
  }
  if (!card.box_noise.is_null()) json["box_noise"] = card.box_noise;
  json["provenance"] = card.provenance;
  return json.dump(1) + "\n";
}

DetectorCard ParseDetectorCard(const std::string& text, const std::string& name) {
  const Json json = ParseCardJson(text, name);
  const CardNode root(json, name);
  root.AllowOnly(
      {"format", "version", "network", "detector", "refiner", "box_noise", "provenance"});
  CheckCardFormat(root, kFormat);
  DetectorCard card;
  card.network = root["network"].Text();
  const CardNode detector = root["detector"];
  detector.AllowOnly({"onnx", "sha256", "min_score"});
  card.detector = ReadWeightsNode(detector);
  card.min_score = detector["min_score"].Number(0.001, 0.999);
  if (root.Has("refiner")) {
    const CardNode refiner = root["refiner"];
    refiner.AllowOnly({"onnx", "sha256", "margin"});
    card.refiner = ReadWeightsNode(refiner);
    card.refiner_margin = refiner["margin"].Number(1, 10);
  }
  if (root.Has("box_noise")) card.box_noise = root["box_noise"].json();
  if (root.Has("provenance")) card.provenance = root["provenance"].json();
  return card;
}

DetectorCard ReadDetectorCard(const std::filesystem::path& file) {
  return ParseDetectorCard(ReadCardText(file, kMaxBytes), file.string());
}

NetworkModel ReadWeights(const DetectorCard::Weights& weights,
                         const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / weights.onnx;
  NetworkModel model = ReadNetwork(file);
  const std::string sha256 = Sha256OfFile(file);
  if (sha256 != weights.sha256) {
    throw ConfigError(fmt::format("{}: must be the file of the card, of sha256 {} (found {})",
                                  file.string(), weights.sha256, sha256));
  }
  CheckGivesBoxes(model, file.string());
  return model;
}

}  // namespace windhover
