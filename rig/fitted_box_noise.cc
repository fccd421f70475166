#include "rig/fitted_box_noise.h"

#include <filesystem>

#include "common/card/card_node.h"
#include "common/config/at_its_place.h"

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = 1 << 20;

/// Of `geometric`: all but where its values come from.
struct JsonWriter {
  void Field(const char*, BoxNoiseSource&, AnyEnum, const char*) {}
  void Field(const char* key, double& value, InRange, const char*) { json[key] = value; }

  nlohmann::ordered_json json = nlohmann::ordered_json::object();
};

struct JsonReader {
  void Field(const char*, BoxNoiseSource&, AnyEnum, const char*) {}
  void Field(const char* key, double& value, InRange limits, const char*) {
    value = node[key].Number(limits.low, limits.high);
  }

  CardNode node;
};

GeometricConfig ReadBoxNoise(const std::filesystem::path& file) {
  const std::string name = file.string();
  const CardNode::Json json = ParseCardJson(ReadCardText(file, kMaxBytes), name);
  const CardNode root(json, name);
  CheckCardFormat(root, "windhover-detector");
  GeometricConfig fitted;
  JsonReader reader{root["box_noise"]};
  fitted.Fields(reader);
  fitted.noise = BoxNoiseSource::kFitted;
  return fitted;
}

}  // namespace

nlohmann::ordered_json BoxNoiseJson(const GeometricConfig& fitted) {
  JsonWriter writer;
  GeometricConfig copy = fitted;
  copy.Fields(writer);
  return writer.json;
}

GeometricConfig ReadFittedBoxNoise(const InputFile& card) {
  return AtItsPlace(card, [&] { return ReadBoxNoise(card.absolute); });
}

}  // namespace windhover
