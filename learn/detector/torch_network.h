#pragma once

#include <memory>
#include <span>
#include <vector>

#include "learn/detector/detector_sample.h"
#include "learn/detector/learned_network.h"
#include "learn/detector/yolox_loss.h"
#include "network/yolox.h"

namespace windhover {

/// Gradients of a network by libtorch, on one thread: an instance for each thread.
class TorchNetwork {
 public:
  explicit TorchNetwork(const YoloxNetwork& network);
  ~TorchNetwork();

  /// The loss of a batch and its gradient by `network`'s parameters; the batch's share enters
  /// `network`'s statistics. Images have one size, a multiple of the largest stride.
  /// @throws std::invalid_argument for a batch that is empty or of mixed sizes.
  YoloxLossParts Gradient(std::span<const DetectorSample> batch, LearnedNetwork* network,
                          std::vector<float>* gradient);

  /// What the network gives out for a batch, level by level, without learning.
  std::vector<std::vector<float>> Outputs(std::span<const DetectorSample> batch,
                                          const LearnedNetwork& network);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace windhover
