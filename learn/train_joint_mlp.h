#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "estimator/joint_mlp.h"
#include "learn/train_pcm.h"

namespace windhover {

struct JointMlpRecipe {
  int epochs = 300;
  int batch = 128;
  double rate = 3e-3;
  double weight_decay = 1e-2;
  int validate_every = 1;  ///< Epochs between looks at the validation split.
  std::uint64_t seed = 1;
};

/// Learns log distances with Huber's loss and AdamW; keeps what is best on `val`.
/// @param start to go on from (fine-tuning), with its scaling of the inputs.
JointMlp TrainJointMlp(std::span<const PcmSample> train, std::span<const PcmSample> val,
                       const JointMlpRecipe& recipe,
                       const std::optional<JointMlp>& start = std::nullopt);

/// Scores as ScorePcm() has them.
PcmScore ScoreJointMlp(const JointMlp& mlp, std::span<const PcmSample> samples);

/// The loss of `mlp` on inputs that are not yet scaled, one column a sample, and its gradient by
/// the weights.
float JointMlpLoss(const JointMlp& mlp, const Eigen::MatrixXf& inputs, const Eigen::VectorXf& log_m,
                   std::vector<float>* gradient);

}  // namespace windhover
