#include "network/layer_table.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

[[noreturn]] void Refuse(const Layer& layer, const std::string& what) {
  throw std::invalid_argument("layer " + layer.name + ": " + what);
}

void Require(bool holds, const Layer& layer, const std::string& what) {
  if (!holds) Refuse(layer, what);
}

bool HasWindow(const Layer& layer) {
  return layer.kind == LayerKind::kConv || layer.kind == LayerKind::kMaxPool;
}

int WindowCount(int length, const Layer& layer) {
  return (length + 2 * ((layer.kernel - 1) / 2) - layer.kernel) / layer.stride + 1;
}

LayerShape WindowShape(const Layer& layer, const LayerShape& in) {
  Require(layer.kernel >= 1 && layer.stride >= 1, layer, "kernel and stride must be positive");
  if (layer.kind == LayerKind::kConv) {
    Require(
        layer.groups >= 1 && in.channels % layer.groups == 0 && layer.channels % layer.groups == 0,
        layer, "groups must divide the channels");
  }
  return {layer.channels, WindowCount(in.height, layer), WindowCount(in.width, layer)};
}

LayerShape JoinedShape(const Layer& layer, const std::vector<LayerShape>& in) {
  LayerShape shape = in.front();
  for (std::size_t i = 1; i < in.size(); ++i) {
    Require(in[i].height == shape.height && in[i].width == shape.width, layer,
            "inputs must have one size");
    if (layer.kind == LayerKind::kConcat) {
      shape.channels += in[i].channels;
    } else {
      Require(in[i].channels == shape.channels, layer, "inputs must have as many channels");
    }
  }
  return shape;
}

LayerShape ShapeOf(const Layer& layer, const std::vector<LayerShape>& in) {
  const bool joins = layer.kind == LayerKind::kConcat || layer.kind == LayerKind::kAdd;
  Require(joins ? in.size() >= 2 : in.size() == 1, layer, "wrong number of inputs");
  if (HasWindow(layer)) return WindowShape(layer, in.front());
  if (joins) return JoinedShape(layer, in);
  return {in.front().channels, 2 * in.front().height, 2 * in.front().width};
}

std::vector<LayerShape> InputShapes(const Layer& layer, const std::vector<LayerShape>& shapes) {
  std::vector<LayerShape> in;
  for (const int i : layer.inputs) {
    Require(i >= 0 && i < static_cast<int>(shapes.size()), layer, "takes what comes later");
    in.push_back(shapes[static_cast<std::size_t>(i)]);
  }
  return in;
}

void CheckOutputs(const LayerTable& table) {
  for (const int output : table.outputs) {
    if (output < 0 || output >= static_cast<int>(table.layers.size())) {
      throw std::invalid_argument(table.name + ": an output is no layer");
    }
  }
}

}  // namespace

std::vector<LayerShape> ShapesOf(const LayerTable& table, int height, int width) {
  std::vector<LayerShape> shapes;
  std::set<std::string> names;
  for (const Layer& layer : table.layers) {
    Require(names.insert(layer.name).second, layer, "has the name of another");
    Require((layer.kind == LayerKind::kInput) == shapes.empty(), layer,
            "the first layer, and no other, is the input");
    const LayerShape shape = shapes.empty() ? LayerShape{layer.channels, height, width}
                                            : ShapeOf(layer, InputShapes(layer, shapes));
    Require(shape.channels == layer.channels, layer, "gives another number of channels");
    Require(shape.channels > 0 && shape.height > 0 && shape.width > 0, layer, "gives nothing");
    shapes.push_back(shape);
  }
  CheckOutputs(table);
  return shapes;
}

int InputChannels(const LayerTable& table, const Layer& layer) {
  return table.layers[static_cast<std::size_t>(layer.inputs.front())].channels;
}

std::int64_t WeightSize(const LayerTable& table, const Layer& layer) {
  return std::int64_t{layer.channels} * (InputChannels(table, layer) / layer.groups) *
         layer.kernel * layer.kernel;
}

std::int64_t ParameterCount(const LayerTable& table) {
  std::int64_t n = 0;
  for (const Layer& layer : table.layers) {
    if (layer.kind != LayerKind::kConv) continue;
    n += WeightSize(table, layer) + (layer.batch_norm ? 2 : 1) * layer.channels;
  }
  return n;
}

std::int64_t MultiplyCount(const LayerTable& table, int height, int width) {
  const std::vector<LayerShape> shapes = ShapesOf(table, height, width);
  std::int64_t n = 0;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (table.layers[i].kind != LayerKind::kConv) continue;
    n += WeightSize(table, table.layers[i]) * shapes[i].height * shapes[i].width;
  }
  return n;
}

void CheckWeights(const LayerTable& table, const NetworkWeights& weights) {
  if (weights.layers.size() != table.layers.size()) {
    throw std::invalid_argument(table.name + ": weights of another number of layers");
  }
  const auto finite = [](const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
  };
  for (std::size_t i = 0; i < table.layers.size(); ++i) {
    const Layer& layer = table.layers[i];
    const ConvWeights& own = weights.layers[i];
    const bool conv = layer.kind == LayerKind::kConv;
    Require(std::ssize(own.weight) == (conv ? WeightSize(table, layer) : 0) &&
                std::ssize(own.bias) == (conv ? layer.channels : 0),
            layer, "wrong number of weights");
    Require(finite(own.weight) && finite(own.bias), layer, "weights must be finite");
  }
}

NetworkWeights RandomWeights(const LayerTable& table, std::uint64_t seed) {
  NetworkWeights weights;
  RandomStream random(seed, "network/weights");
  for (const Layer& layer : table.layers) {
    ConvWeights& own = weights.layers.emplace_back();
    if (layer.kind != LayerKind::kConv) continue;
    own.weight.resize(static_cast<std::size_t>(WeightSize(table, layer)));
    own.bias.resize(static_cast<std::size_t>(layer.channels));
    const double fan_in = static_cast<double>(own.weight.size() / own.bias.size());
    for (float& w : own.weight) w = static_cast<float>(random.Normal() * std::sqrt(2 / fan_in));
    for (float& b : own.bias) b = static_cast<float>(0.1 * random.Normal());
  }
  return weights;
}

}  // namespace windhover
