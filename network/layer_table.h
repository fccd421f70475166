#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace windhover {

enum class LayerKind { kInput, kConv, kMaxPool, kUpsample, kConcat, kAdd };
enum class Activation { kNone, kSilu, kRelu };

/// One operation on images of shape channels × height × width.
struct Layer {
  LayerKind kind = LayerKind::kInput;
  std::string name;         ///< Unique; its weights are called NAME.weight and NAME.bias.
  std::vector<int> inputs;  ///< Indices of earlier layers.
  int channels = 0;         ///< Of what it gives.
  int kernel = 1;  ///< Of kConv and kMaxPool, in both directions; padded by (kernel - 1) / 2.
  int stride = 1;  ///< Of kConv and kMaxPool.
  int groups = 1;  ///< Of kConv; as many as channels: depthwise.
  Activation activation = Activation::kNone;  ///< Of kConv, after the bias.
  bool batch_norm = false;  ///< Of kConv: learned with batch normalisation in the bias's place.
};

struct LayerShape {
  int channels = 0, height = 0, width = 0;
  bool operator==(const LayerShape&) const = default;
};

/// A convolutional network, independent of what runs it. Layers come after what they take;
/// layer 0 is the one input. A maximum is taken over what is inside the image; kUpsample repeats
/// every pixel twice in both directions; kConcat joins channels.
struct LayerTable {
  std::string name;
  std::vector<Layer> layers;
  std::vector<int> outputs;  ///< Indices of the layers that the network gives out.
};

/// The shape of each layer's result for an input of that size.
/// @throws std::invalid_argument naming the layer whose inputs do not fit it.
std::vector<LayerShape> ShapesOf(const LayerTable& table, int height, int width);

/// Channels that `layer` takes.
int InputChannels(const LayerTable& table, const Layer& layer);

/// Numbers in the weight of a kConv: channels × (input channels / groups) × kernel × kernel.
std::int64_t WeightSize(const LayerTable& table, const Layer& layer);

/// Numbers that are learned; batch normalisation has two for each channel, a bias one.
std::int64_t ParameterCount(const LayerTable& table);

/// Multiply-accumulates of the convolutions for one input of that size.
std::int64_t MultiplyCount(const LayerTable& table, int height, int width);

/// Of one kConv, batch normalisation folded in.
struct ConvWeights {
  std::vector<float> weight;  ///< Output channel, input channel of its group, row, column.
  std::vector<float> bias;    ///< For each output channel.
};

/// What a network has learned: an element for each layer of its table, empty where that is no
/// kConv.
struct NetworkWeights {
  std::vector<ConvWeights> layers;
};

/// @throws std::invalid_argument naming the layer whose weights have the wrong number or are not
/// finite.
void CheckWeights(const LayerTable& table, const NetworkWeights& weights);

/// Weights for tests and benchmarks: zero mean, variance 2 / (inputs of a neuron), from `seed`.
NetworkWeights RandomWeights(const LayerTable& table, std::uint64_t seed);

}  // namespace windhover
