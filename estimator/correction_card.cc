#include "estimator/correction_card.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "common/card/card_node.h"
#include "common/config/at_its_place.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "windhover-correction";
constexpr std::uintmax_t kMaxBytes = 16 << 20;
constexpr std::size_t kMaxStages = 8;

// With as few digits as tell one float from the next.
Json Short(float value) { return std::stod(fmt::format("{}", value)); }

Json Short(std::span<const float> values) {
  Json list = Json::array();
  for (const float value : values) list.push_back(Short(value));
  return list;
}

Json PcmJson(const PcmStages& pcm) {
  Json stages = Json::array();
  for (std::size_t i = 0; i < pcm.offsets.size(); ++i) {
    Json stage = {{"offset", Short(pcm.offsets[i].parameters())}};
    if (i < pcm.gates.size()) stage["gate"] = Short(pcm.gates[i].parameters());
    stages.push_back(std::move(stage));
  }
  Json json = {{"width", pcm.offsets.front().width()},
               {"range_sigma", pcm.range_sigma},
               {"stages", std::move(stages)}};
  if (pcm.alone) json["alone"] = Short(pcm.alone->parameters());
  return json;
}

Json JointMlpJson(const JointMlp::Parameters& mlp) {
  const auto list = [](const JointMlp::Inputs& v) {
    return Short({v.data(), v.data() + v.size()});
  };
  return {{"range_sigma", mlp.range_sigma},
          {"mean", list(mlp.mean)},
          {"scale", list(mlp.scale)},
          {"mean_log_m", Short(mlp.mean_log_m)},
          {"weights", Short(mlp.weights)}};
}

Json PriorsJson(FittedPriors priors) {
  Json json;
  priors.ForEach(
      [&](const char* name, const double* value, double, double) { json[name] = *value; });
  return json;
}

PcmStages ReadPcm(const CardNode& node) {
  node.AllowOnly({"width", "range_sigma", "stages", "alone"});
  const CardNode width_node = node["width"];
  const int width = static_cast<int>(width_node.Number(1, 1000));
  if (std::count(kMixerWidths.begin(), kMixerWidths.end(), width) == 0) {
    width_node.MustBe("4 or 96", fmt::format("'{}'", width));
  }
  PcmStages pcm;
  const std::vector<CardNode> stages = node["stages"].Items(kMaxStages);
  for (std::size_t i = 0; i < stages.size(); ++i) {
    stages[i].AllowOnly({"offset", "gate"});
    pcm.offsets.emplace_back(width, 1, stages[i]["offset"].Numbers(MixerParameters(width, 1)));
    if (i + 1 == stages.size()) break;
    pcm.gates.emplace_back(width, 2, stages[i]["gate"].Numbers(MixerParameters(width, 2)));
  }
  if (node.Has("alone")) {
    pcm.alone.emplace(width, 1, node["alone"].Numbers(MixerParameters(width, 1)));
  }
  const auto sigmas = node["range_sigma"].Items(3);
  if (sigmas.size() != 3) node["range_sigma"].MustBe("3 numbers", fmt::format("{}", sigmas.size()));
  for (std::size_t i = 0; i < 3; ++i) pcm.range_sigma[i] = sigmas[i].Number(0, 10);
  return pcm;
}

JointMlp ReadJointMlp(const CardNode& node) {
  node.AllowOnly({"range_sigma", "mean", "scale", "mean_log_m", "weights"});
  JointMlp::Parameters mlp;
  const auto fill = [&](const char* key, JointMlp::Inputs* to) {
    *to = JointMlp::Inputs(node[key].Numbers(JointMlp::kInputs).data());
  };
  fill("mean", &mlp.mean);
  fill("scale", &mlp.scale);
  if (!(mlp.scale.minCoeff() > 0)) node["scale"].MustBe("above 0", "one that is not");
  mlp.mean_log_m = static_cast<float>(node["mean_log_m"].Number(-20, 20));
  mlp.weights = node["weights"].Numbers(JointMlp::kParameters);
  mlp.range_sigma = node["range_sigma"].Number(0, 10);
  return JointMlp(std::move(mlp));
}

FittedPriors ReadPriors(const CardNode& node) {
  FittedPriors priors;
  priors.ForEach([&](const char* name, double* value, double low, double high) {
    *value = node[name].Number(low, high);
  });
  return priors;
}

}  // namespace

std::string CorrectionCardText(const CorrectionCard& card) {
  Json json = {{"format", kFormat}, {"version", 1}, {"provenance", card.provenance}};
  if (card.priors) json["priors"] = PriorsJson(*card.priors);
  if (card.pcm) json["pcm"] = PcmJson(*card.pcm);
  if (card.joint_mlp) json["joint_mlp"] = JointMlpJson(card.joint_mlp->parameters());
  return json.dump(1) + "\n";
}

CorrectionCard ParseCorrectionCard(const std::string& text, const std::string& name) {
  const Json json = ParseCardJson(text, name);
  const CardNode root(json, name);
  root.AllowOnly({"format", "version", "provenance", "priors", "pcm", "joint_mlp"});
  CheckCardFormat(root, kFormat);
  CorrectionCard card;
  if (root.Has("provenance")) card.provenance = root["provenance"].json();
  if (root.Has("priors")) card.priors = ReadPriors(root["priors"]);
  if (root.Has("pcm")) card.pcm = ReadPcm(root["pcm"]);
  if (root.Has("joint_mlp")) card.joint_mlp = ReadJointMlp(root["joint_mlp"]);
  return card;
}

CorrectionCard ReadCorrectionCard(const std::filesystem::path& file) {
  return ParseCorrectionCard(ReadCardText(file, kMaxBytes), file.string());
}

CorrectionCard ReadCorrectionCard(const InputFile& file) {
  return AtItsPlace(file, [&] { return ReadCorrectionCard(std::filesystem::path(file.absolute)); });
}

}  // namespace windhover
