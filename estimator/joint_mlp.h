#pragma once

#include <array>
#include <optional>
#include <vector>

#include "estimator/pcm.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// A network from everything that both boxes say to the logarithm of a distance: the simplest
/// learned estimator that does not correct positions. Two hidden layers of kHidden with SiLU.
class JointMlp {
 public:
  static constexpr int kInputs = 8, kHidden = 32;
  static constexpr int kParameters =
      kHidden * (kInputs + 1) + kHidden * (kHidden + 1) + (kHidden + 1);
  using Inputs = Eigen::Matrix<float, kInputs, 1>;

  /// Logarithms of the triangulated range and of the boxes' angular sizes, positions, and how
  /// both boxes differ.
  static Inputs InputsOf(const CorrectableBoxes& boxes);

  /// `mean`, `scale` of the inputs, log metres of an average target, then the parameters: layer
  /// by layer, weights output by output, then biases.
  struct Parameters {
    Inputs mean, scale;
    float mean_log_m = 0;
    std::vector<float> weights;
    double range_sigma = 0.1;  ///< Relative standard deviation of the range.
  };
  /// @throws std::invalid_argument unless there are kParameters weights.
  explicit JointMlp(Parameters parameters);

  float LogRange(const Inputs& inputs) const;
  const Parameters& parameters() const { return parameters_; }

 private:
  Parameters parameters_;
};

/// `joint_mlp`
class JointMlpEstimator final : public RangeEstimator {
 public:
  JointMlpEstimator(const AircraftConfig& config, JointMlp mlp);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  JointMlp mlp_;
};

}  // namespace windhover
