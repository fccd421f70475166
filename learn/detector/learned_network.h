#pragma once

#include <cstdint>
#include <vector>

#include "network/layer_table.h"

namespace windhover {

/// A network while it learns, as plain numbers in the order of its table. For each convolution
/// `parameters` has the weight, then gamma and beta of its batch normalisation or its bias, and
/// `statistics` running mean and variance of its batch normalisation.
struct LearnedNetwork {
  std::vector<float> parameters, statistics;
};

/// Batch normalisation divides by sqrt(variance + this), as YOLOX's.
inline constexpr float kNormEpsilon = 1e-3f;

/// Where a convolution's numbers start.
struct ParameterPlace {
  std::size_t weight, after_weight;  ///< In `parameters`; what follows is gamma or the bias.
  std::size_t mean;                  ///< In `statistics`; the variance is `channels` further.
};

/// For each layer; those that are no convolution have that of the next.
std::vector<ParameterPlace> PlacesOf(const LayerTable& table);

/// Before learning: K. He's initial weights; predictions start near 0, scores at 0.01.
LearnedNetwork InitialNetwork(const LayerTable& table, std::uint64_t seed);

/// Batch normalisation becomes part of weights and biases.
NetworkWeights Folded(const LayerTable& table, const LearnedNetwork& network);

}  // namespace windhover
