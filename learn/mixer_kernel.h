#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/cpu/instruction_set.h"
#include "estimator/mixer.h"

namespace windhover {

/// Sixteen boxes at once through one mixer (estimator/mixer_pass.h) and back, for training.
/// Every instruction set gives the same bits.
class MixerKernel {
 public:
  static constexpr int kBoxes = 16;
  using Tokens = std::array<std::array<float, kBoxes>, 4>;
  using Outputs = std::array<std::array<float, kBoxes>, 2>;  ///< The second of a gate only.

  virtual ~MixerKernel() = default;

  /// Outputs for the boxes of `x`, by output, then by box.
  virtual void Forward(const float* parameters, const Tokens& x, Outputs* out) = 0;

  /// Adds to the gradient what the last Forward() does to a loss that changes by `d_out`.
  virtual void Backward(const float* parameters, const Outputs& d_out) = 0;

  /// The gradient since the last call.
  virtual void TakeGradient(std::vector<float>* gradient) = 0;
};

/// @throws std::invalid_argument for a width that no mixer has.
std::unique_ptr<MixerKernel> MakeMixerKernel(int width, int n_outputs,
                                             InstructionSet instructions = WidestInstructionSet());

}  // namespace windhover
