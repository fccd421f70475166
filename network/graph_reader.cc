#include "network/graph_reader.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/config/fields.h"
#include "network/onnx_node.h"

namespace windhover {
namespace {

using Node = OnnxGraph::Node;
using Tensor = OnnxGraph::Tensor;
using Lengths = OnnxNode::Lengths;

constexpr std::size_t kMaxNodes = 2000, kMaxChannels = 4096;
constexpr int kMaxSide_px = 2048, kSideStep_px = 32;
constexpr std::int64_t kMaxResults = 64 << 20, kMaxMultiplies = 50'000'000'000;
constexpr int kMinOpset = 11, kMaxOpset = 17;

/// Brings the nodes of a graph, one after the other, into a table of layers.
class GraphReader {
 public:
  GraphReader(const OnnxGraph& graph, std::string name) : graph_(graph), name_(std::move(name)) {}

  NetworkModel Read() {
    CheckCounts();
    for (const Tensor& tensor : graph_.initializers) initializers_[tensor.name] = &tensor;
    for (const Node& node : graph_.nodes) {
      for (const std::string& input : node.inputs) ++uses_[input];
    }
    for (const std::string& output : graph_.outputs) ++uses_[output];
    ReadInput();
    for (const Node& node : graph_.nodes) ReadNode(OnnxNode(node, name_));
    for (const std::string& output : graph_.outputs) ReadOutput(output);
    CheckAll();
    return std::move(model_);
  }

 private:
  [[noreturn]] void Refuse(const std::string& where, const std::string& must,
                           const std::string& found) const {
    throw ConfigError(fmt::format("{}: {}: must be {} (found {})", name_, where, must, found));
  }
  void CheckCounts() const {
    if (graph_.opset < kMinOpset || graph_.opset > kMaxOpset) {
      Refuse("opset", fmt::format("the standard one, {} to {}", kMinOpset, kMaxOpset),
             graph_.opset == 0 ? "another" : fmt::format("{}", graph_.opset));
    }
    if (graph_.nodes.empty() || graph_.nodes.size() > kMaxNodes) {
      Refuse("nodes", fmt::format("1 to {}", kMaxNodes), fmt::format("{}", graph_.nodes.size()));
    }
    if (graph_.outputs.empty() || graph_.outputs.size() > 8) {
      Refuse("outputs", "1 to 8", fmt::format("{}", graph_.outputs.size()));
    }
  }

  void ReadInput() {
    const OnnxGraph::Value* input = nullptr;
    std::size_t n_inputs = 0;
    for (const OnnxGraph::Value& value : graph_.inputs) {
      if (initializers_.count(value.name) > 0) continue;
      input = &value;
      ++n_inputs;
    }
    if (n_inputs != 1) Refuse("inputs", "one image", fmt::format("{}", n_inputs));
    const Lengths& lengths = input->lengths;
    const auto is_side = [](std::int64_t side) {
      return side >= kSideStep_px && side <= kMaxSide_px && side % kSideStep_px == 0;
    };
    if (lengths.size() != 4 || lengths[0] != 1 || lengths[1] != 3 || !is_side(lengths[2]) ||
        !is_side(lengths[3])) {
      Refuse(fmt::format("input {}", input->name),
             fmt::format("float32 of 1 x 3 x height x width, multiples of {} up to {}",
                         kSideStep_px, kMaxSide_px),
             fmt::format("[{}]", fmt::join(lengths, ", ")));
    }
    model_.height = static_cast<int>(lengths[2]);
    model_.width = static_cast<int>(lengths[3]);
    Add({.kind = LayerKind::kInput, .name = input->name, .inputs = {}, .channels = 3}, input->name);
  }

  void ReadNode(const OnnxNode& node) {
    if (node.outputs().size() != 1 || layers_.count(node.outputs().front()) > 0) {
      node.Refuse("of one output with a name of its own", fmt::format("{}", node.outputs().size()));
    }
    static const std::map<std::string, void (GraphReader::*)(const OnnxNode&)> kReaders = {
        {"Conv", &GraphReader::ReadConv},        {"Relu", &GraphReader::ReadRelu},
        {"Sigmoid", &GraphReader::ReadSigmoid},  {"Mul", &GraphReader::ReadSilu},
        {"MaxPool", &GraphReader::ReadMaxPool},  {"Resize", &GraphReader::ReadUpsample},
        {"Concat", &GraphReader::ReadConcat},    {"Add", &GraphReader::ReadAdd},
        {"Identity", &GraphReader::ReadIdentity}};
    const auto reader = kReaders.find(node.op());
    if (reader == kReaders.end()) {
      std::vector<std::string> known;
      for (const auto& [op, ignored] : kReaders) known.push_back(op);
      node.Refuse(fmt::format("of {}", fmt::join(known, ", ")), node.op());
    }
    (this->*reader->second)(node);
  }

  void ReadOutput(const std::string& name) {
    const auto layer = layers_.find(name);
    if (layer == layers_.end()) Refuse("output " + name, "what a node gives", "nothing");
    if (layer->second == 0) Refuse("output " + name, "what a node gives", "the input");
    // Engines know outputs by these names.
    LayerAt(layer->second).name = name;
    model_.table.outputs.push_back(layer->second);
  }

  void CheckAll() const {
    try {
      CheckWeights(model_.table, model_.weights);
      std::int64_t results = 0;
      for (const LayerShape& shape : ShapesOf(model_.table, model_.height, model_.width)) {
        results += std::int64_t{shape.channels} * shape.height * shape.width;
      }
      if (results > kMaxResults) {
        Refuse("results", fmt::format("at most {} numbers", kMaxResults),
               fmt::format("{}", results));
      }
      const std::int64_t multiplies = MultiplyCount(model_.table, model_.height, model_.width);
      if (multiplies > kMaxMultiplies) {
        Refuse("convolutions", fmt::format("at most {} multiplications", kMaxMultiplies),
               fmt::format("{}", multiplies));
      }
    } catch (const std::invalid_argument& error) {
      throw ConfigError(fmt::format("{}: {}", name_, error.what()));
    }
  }

  // --- Nodes. -------------------------------------------------------------------------------

  Layer& LayerAt(int index) { return model_.table.layers[static_cast<std::size_t>(index)]; }

  void Add(Layer layer, const std::string& output, ConvWeights weights = {}) {
    model_.table.layers.push_back(std::move(layer));
    model_.weights.layers.push_back(std::move(weights));
    layers_[output] = static_cast<int>(model_.table.layers.size()) - 1;
  }

  int In(const OnnxNode& node, std::size_t i = 0) const {
    const auto layer = i < node.inputs().size() ? layers_.find(node.inputs()[i]) : layers_.end();
    if (layer == layers_.end()) {
      node.Refuse(fmt::format("given the result of an earlier node as its input {}", i),
                  i < node.inputs().size() ? "'" + node.inputs()[i] + "'" : "nothing");
    }
    return layer->second;
  }

  std::vector<int> AllIn(const OnnxNode& node) const {
    std::vector<int> inputs;
    for (std::size_t i = 0; i < node.inputs().size(); ++i) inputs.push_back(In(node, i));
    return inputs;
  }

  const Tensor& Learned(const OnnxNode& node, std::size_t i) const {
    const auto tensor =
        i < node.inputs().size() ? initializers_.find(node.inputs()[i]) : initializers_.end();
    if (tensor == initializers_.end() || !tensor->second->is_float) {
      node.Refuse(fmt::format("given float32 numbers of the file as its input {}", i),
                  i < node.inputs().size() ? "'" + node.inputs()[i] + "'" : "nothing");
    }
    return *tensor->second;
  }

  void ReadConv(const OnnxNode& node) {
    node.AllowOnly({"kernel_shape", "strides", "pads", "group", "dilations", "auto_pad"});
    const Tensor& weight = Learned(node, 1);
    const Lengths& lengths = weight.lengths;
    const auto is_length = [](std::int64_t length) {
      return length >= 1 && length <= static_cast<std::int64_t>(kMaxChannels);
    };
    if (lengths.size() != 4 || !std::all_of(lengths.begin(), lengths.end(), is_length)) {
      node.Refuse("given weights of four lengths", fmt::format("[{}]", fmt::join(lengths, ", ")));
    }
    Layer layer{.kind = LayerKind::kConv, .name = weight.name, .inputs = {In(node)}};
    if (layer.name.ends_with(".weight")) layer.name.resize(layer.name.size() - 7);
    layer.channels = static_cast<int>(lengths[0]);
    node.ReadWindow({lengths[2], lengths[3]}, &layer);
    const Lengths groups = node.Ints("group", {1});
    const int in_channels = LayerAt(layer.inputs.front()).channels;
    if (groups.size() != 1 || groups[0] < 1 || groups[0] * lengths[1] != in_channels ||
        lengths[0] % groups[0] != 0) {
      node.Refuse(fmt::format("of groups that fit {} channels", in_channels),
                  fmt::format("[{}] of {}", fmt::join(groups, ", "), lengths[1]));
    }
    layer.groups = static_cast<int>(groups[0]);
    const Tensor& bias = Learned(node, 2);
    if (bias.lengths != Lengths{lengths[0]}) {
      node.Refuse("given a bias for each channel",
                  fmt::format("{}", fmt::join(bias.lengths, ", ")));
    }
    Add(std::move(layer), node.outputs().front(), {weight.values, bias.values});
  }

  /// The convolution whose result goes nowhere but through an activation, in `n_uses` places.
  int BeforeActivation(const OnnxNode& node, int n_uses) {
    const int layer = In(node);
    if (LayerAt(layer).kind != LayerKind::kConv || LayerAt(layer).activation != Activation::kNone ||
        uses_[node.inputs()[0]] != n_uses) {
      node.Refuse("the only use of a convolution's result", "'" + node.inputs()[0] + "'");
    }
    return layer;
  }

  void ReadRelu(const OnnxNode& node) {
    const int layer = BeforeActivation(node, 1);
    LayerAt(layer).activation = Activation::kRelu;
    layers_[node.outputs().front()] = layer;
  }

  void ReadSigmoid(const OnnxNode& node) {
    BeforeActivation(node, 2);
    sigmoids_[node.outputs().front()] = node.inputs().front();
  }

  void ReadSilu(const OnnxNode& node) {
    const auto sigmoid =
        node.inputs().size() == 2 ? sigmoids_.find(node.inputs()[1]) : sigmoids_.end();
    if (sigmoid == sigmoids_.end() || sigmoid->second != node.inputs()[0] ||
        uses_[node.inputs()[1]] != 1) {
      node.Refuse("x times the sigmoid of x",
                  fmt::format("{}", fmt::join(node.inputs(), " times ")));
    }
    const int layer = BeforeActivation(node, 2);
    LayerAt(layer).activation = Activation::kSilu;
    layers_[node.outputs().front()] = layer;
  }

  void ReadMaxPool(const OnnxNode& node) {
    node.AllowOnly(
        {"kernel_shape", "strides", "pads", "dilations", "auto_pad", "ceil_mode", "storage_order"});
    node.MustEqual("ceil_mode", {0}, {0});
    node.MustEqual("storage_order", {0}, {0});
    Layer layer{.kind = LayerKind::kMaxPool, .name = node.outputs().front(), .inputs = {In(node)}};
    layer.channels = LayerAt(layer.inputs.front()).channels;
    node.ReadWindow(node.Ints("kernel_shape", {}), &layer);
    Add(std::move(layer), node.outputs().front());
  }

  void ReadUpsample(const OnnxNode& node) {
    node.AllowOnly({"mode", "coordinate_transformation_mode", "nearest_mode"});
    node.MustSay("mode", "nearest", "nearest");
    node.MustSay("coordinate_transformation_mode", "asymmetric", "half_pixel");
    node.MustSay("nearest_mode", "floor", "round_prefer_floor");
    const bool has_roi = node.inputs().size() > 1 && !node.inputs()[1].empty();
    if (node.inputs().size() != 3 || has_roi ||
        Learned(node, 2).values != std::vector<float>{1, 1, 2, 2}) {
      node.Refuse("of scales 1, 1, 2, 2", "others");
    }
    Layer layer{.kind = LayerKind::kUpsample, .name = node.outputs().front(), .inputs = {In(node)}};
    layer.channels = LayerAt(layer.inputs.front()).channels;
    Add(std::move(layer), node.outputs().front());
  }

  void ReadConcat(const OnnxNode& node) {
    node.AllowOnly({"axis"});
    node.MustEqual("axis", {1}, {});
    Layer layer{.kind = LayerKind::kConcat, .name = node.outputs().front(), .inputs = AllIn(node)};
    for (const int input : layer.inputs) layer.channels += LayerAt(input).channels;
    Add(std::move(layer), node.outputs().front());
  }

  void ReadAdd(const OnnxNode& node) {
    Layer layer{.kind = LayerKind::kAdd, .name = node.outputs().front(), .inputs = AllIn(node)};
    if (layer.inputs.size() != 2) {
      node.Refuse("of two inputs", fmt::format("{}", layer.inputs.size()));
    }
    layer.channels = LayerAt(layer.inputs.front()).channels;
    Add(std::move(layer), node.outputs().front());
  }

  void ReadIdentity(const OnnxNode& node) { layers_[node.outputs().front()] = In(node); }

  const OnnxGraph& graph_;
  std::string name_;
  NetworkModel model_;
  std::map<std::string, const Tensor*> initializers_;
  std::map<std::string, int> uses_;    ///< Of a tensor, as an input or the graph's output.
  std::map<std::string, int> layers_;  ///< The layer that gives a tensor.
  std::map<std::string, std::string> sigmoids_;  ///< Of what, that wait to be multiplied by it.
};

}  // namespace

NetworkModel ReadGraph(const OnnxGraph& graph, const std::string& name) {
  return GraphReader(graph, name).Read();
}

}  // namespace windhover
