#include "estimator/correction_card.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "windhover-correction";
constexpr std::uintmax_t kMaxBytes = 16 << 20;
constexpr std::size_t kMaxStages = 8;
constexpr double kMaxWeight = 1e6;

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

// A value of a card and the keys that lead there.
class CardNode {
 public:
  CardNode(const Json& json, std::string name, std::string path)
      : json_(json), name_(std::move(name)), path_(std::move(path)) {}

  [[noreturn]] void MustBe(const std::string& must, const std::string& found) const {
    throw ConfigError(fmt::format("{}: {}: must be {} (found {})", name_,
                                  path_.empty() ? "the card" : path_, must, found));
  }

  CardNode operator[](const std::string& key) const {
    RequireObject();
    const auto it = json_.find(key);
    const std::string path = path_.empty() ? key : path_ + "." + key;
    if (it == json_.end()) CardNode(json_, name_, path).MustBe("there", "nothing");
    return {*it, name_, path};
  }
  bool Has(const std::string& key) const { return json_.is_object() && json_.contains(key); }

  std::vector<CardNode> Items(std::size_t most) const {
    if (!json_.is_array() || json_.empty() || json_.size() > most) {
      MustBe(fmt::format("a list of 1 to {}", most), Found());
    }
    std::vector<CardNode> items;
    for (std::size_t i = 0; i < json_.size(); ++i) {
      items.emplace_back(json_[i], name_, fmt::format("{}.{}", path_, i));
    }
    return items;
  }

  double Number(double low, double high) const {
    const double value = json_.is_number() ? json_.get<double>() : NAN;
    if (!(value >= low && value <= high)) {
      MustBe(fmt::format("a number from {:g} to {:g}", low, high), Found());
    }
    return value;
  }

  std::vector<float> Numbers(int n) const {
    const auto count = static_cast<std::size_t>(n);
    if (!json_.is_array() || json_.size() != count) {
      MustBe(fmt::format("{} numbers", count), Found());
    }
    std::vector<float> values;
    for (const CardNode& item : Items(count)) {
      values.push_back(static_cast<float>(item.Number(-kMaxWeight, kMaxWeight)));
    }
    return values;
  }

  void AllowOnly(std::initializer_list<const char*> keys) const {
    RequireObject();
    for (const auto& [key, value] : json_.items()) {
      const bool known = std::any_of(keys.begin(), keys.end(),
                                     [&, &name = key](const char* one) { return name == one; });
      if (!known) MustBe(fmt::format("of {}", fmt::join(keys, ", ")), fmt::format("'{}'", key));
    }
  }

  const Json& json() const { return json_; }

 private:
  void RequireObject() const {
    if (!json_.is_object()) MustBe("an object", Found());
  }
  std::string Found() const {
    if (json_.is_array()) return fmt::format("a list of {}", json_.size());
    if (json_.is_object()) return "an object";
    return fmt::format("'{}'", json_.dump());
  }

  const Json& json_;
  std::string name_, path_;
};

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

// Where byte `at` of a text is, as compilers count.
std::string LineAndColumn(const std::string& text, std::size_t at) {
  const std::size_t end = std::min(at == 0 ? 0 : at - 1, text.size());
  const auto begin = text.begin(), stop = begin + static_cast<std::ptrdiff_t>(end);
  const std::size_t newline = text.rfind('\n', end == 0 ? 0 : end - 1);
  const bool on_first = newline == std::string::npos || newline >= end;
  return fmt::format("{}:{}", 1 + std::count(begin, stop, '\n'),
                     on_first ? end + 1 : end - newline);
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
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw ConfigError(fmt::format("{}:{}: must be JSON, whole and readable", name,
                                  LineAndColumn(text, error.byte)));
  } catch (const Json::exception&) {  // Such as numbers that are too large.
    throw ConfigError(fmt::format("{}: must be JSON with finite numbers", name));
  }
  const CardNode root(json, name, "");
  root.AllowOnly({"format", "version", "provenance", "priors", "pcm", "joint_mlp"});
  if (root["format"].json() != kFormat) {
    root["format"].MustBe(fmt::format("'{}'", kFormat), root["format"].json().dump());
  }
  root["version"].Number(1, 1);
  CorrectionCard card;
  if (root.Has("provenance")) card.provenance = root["provenance"].json();
  if (root.Has("priors")) card.priors = ReadPriors(root["priors"]);
  if (root.Has("pcm")) card.pcm = ReadPcm(root["pcm"]);
  if (root.Has("joint_mlp")) card.joint_mlp = ReadJointMlp(root["joint_mlp"]);
  return card;
}

CorrectionCard ReadCorrectionCard(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) {
    throw ConfigError(fmt::format("{}: must be a file that can be read", file.string()));
  }
  if (bytes > kMaxBytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", file.string(), kMaxBytes, bytes));
  }
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return ParseCorrectionCard(text, file.string());
}

CorrectionCard ReadCorrectionCard(const InputFile& file) {
  try {
    return ReadCorrectionCard(std::filesystem::path(file.absolute));
  } catch (const ConfigError& error) {
    throw ConfigError(file.where.empty() ? error.what()
                                         : fmt::format("{}: {}", file.where, error.what()));
  }
}

}  // namespace windhover
