#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "learn/detector/detector_sample.h"
#include "learn/detector/learned_network.h"
#include "learn/detector/yolox_loss.h"
#include "network/yolox.h"

namespace windhover {

/// How a detector learns: AdamW, a rate that warms up and then falls along half a cosine, and a
/// moving average of the weights, which is what counts.
struct DetectorRecipe {
  std::string network = "yolox_small";  ///< One of kYoloxNetworks.
  int steps = 20000;
  double rate = 2e-3;     ///< The largest.
  double warm_up = 0.03;  ///< Share of the steps.
  double weight_decay = 0.01;
  double clip = 10;               ///< Largest norm of a gradient.
  double average_decay = 0.9998;  ///< At most: early averages reach back a tenth of the steps.
  std::uint64_t seed = 1;         ///< Of initial weights.
};

nlohmann::ordered_json ToJson(const DetectorRecipe& recipe);

/// A network without batch normalisation, for going on from folded weights.
YoloxNetwork WithoutNorm(YoloxNetwork network);

/// Learns step by step. A batch is learned in two halves whose gradients are added, so the bits
/// depend on batches and recipe, and not on the number of threads (but on the processor's
/// instructions, which choose libtorch's kernels).
class DetectorTrainer {
 public:
  /// @param start weights to go on from (fine-tuning); nothing: random ones.
  /// @throws std::invalid_argument for a network that is none or a start that does not fit.
  DetectorTrainer(const DetectorRecipe& recipe, int threads,
                  const std::optional<NetworkWeights>& start = std::nullopt);
  ~DetectorTrainer();

  /// @return nothing if the gradient was not finite: training has diverged.
  std::optional<YoloxLossParts> Step(const std::vector<DetectorSample>& batch);

  /// Lets the averaged network's statistics follow those of a batch, and learns nothing: for
  /// those that differ from what training saw most of, and after a hundred batches are theirs.
  /// Source: Y. Wu, J. Johnson, "Rethinking \"Batch\" in BatchNorm", arXiv 2105.07576, 3.
  void Settle(const std::vector<DetectorSample>& batch);

  int steps_done() const;
  const YoloxNetwork& network() const;

  /// The averaged network, batch normalisation folded in; it fits MakeYolox(recipe.network).
  NetworkWeights Average() const;

  /// All that Step() depends on but batches and recipe.
  nlohmann::json State() const;
  /// @throws std::exception if it is no state of such a training.
  void Restore(const nlohmann::json& state);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace windhover
