#include "learn/detector/learned_network.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr float kPredictionScale = 0.05f;
constexpr float kFirstLogit = -4.595f;  // Of 0.01.

}  // namespace

std::vector<ParameterPlace> PlacesOf(const LayerTable& table) {
  std::vector<ParameterPlace> places;
  ParameterPlace place{};
  for (const Layer& layer : table.layers) {
    const bool conv = layer.kind == LayerKind::kConv;
    const auto weight = conv ? static_cast<std::size_t>(WeightSize(table, layer)) : 0;
    const auto channels = conv ? static_cast<std::size_t>(layer.channels) : 0;
    place.after_weight = place.weight + weight;
    places.push_back(place);
    place.weight = place.after_weight + (layer.batch_norm ? 2 : 1) * channels;
    if (layer.batch_norm) place.mean += 2 * channels;
  }
  return places;
}

LearnedNetwork InitialNetwork(const LayerTable& table, std::uint64_t seed) {
  NetworkWeights random = RandomWeights(table, seed);
  LearnedNetwork network;
  for (std::size_t i = 0; i < table.layers.size(); ++i) {
    const Layer& layer = table.layers[i];
    if (layer.kind != LayerKind::kConv) continue;
    std::vector<float>& weight = random.layers[i].weight;
    const auto channels = static_cast<std::size_t>(layer.channels);
    if (!layer.batch_norm) {
      for (float& w : weight) w *= kPredictionScale;
    }
    auto& p = network.parameters;
    p.insert(p.end(), weight.begin(), weight.end());
    p.insert(p.end(), channels, layer.batch_norm ? 1.0f : 0.0f);
    if (layer.batch_norm) {
      p.insert(p.end(), channels, 0.0f);
      network.statistics.insert(network.statistics.end(), channels, 0.0f);
      network.statistics.insert(network.statistics.end(), channels, 1.0f);
    } else {
      p.back() = kFirstLogit;  // The last of box_obj and the only one of class are scores.
    }
  }
  return network;
}

NetworkWeights Folded(const LayerTable& table, const LearnedNetwork& network) {
  const std::vector<ParameterPlace> places = PlacesOf(table);
  NetworkWeights weights;
  for (std::size_t i = 0; i < table.layers.size(); ++i) {
    const Layer& layer = table.layers[i];
    ConvWeights& own = weights.layers.emplace_back();
    if (layer.kind != LayerKind::kConv) continue;
    const auto channels = static_cast<std::size_t>(layer.channels);
    const float* weight = network.parameters.data() + places[i].weight;
    const float* after = network.parameters.data() + places[i].after_weight;
    own.weight.assign(weight, after);
    own.bias.assign(after, after + channels);
    if (!layer.batch_norm) continue;
    const float* mean = network.statistics.data() + places[i].mean;
    const std::size_t size = own.weight.size() / channels;
    for (std::size_t c = 0; c < channels; ++c) {
      const float scale = after[c] / std::sqrt(mean[channels + c] + kNormEpsilon);
      for (std::size_t k = 0; k < size; ++k) own.weight[c * size + k] *= scale;
      own.bias[c] = after[channels + c] - scale * mean[c];
    }
  }
  return weights;
}

}  // namespace windhover
