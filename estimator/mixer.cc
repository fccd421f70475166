#include "estimator/mixer.h"

#include <stdexcept>

#include <fmt/format.h>

#include "common/cpu/instruction_set.h"
#include "estimator/mixer_four.h"
#include "estimator/mixer_pass.h"

namespace windhover {
namespace {

using Pair = FloatLanes<4>::Type;  // Left and right; two lanes stay empty.

template <int kWidth, int kOutputs>
std::array<std::array<float, 2>, 2> EvaluateAs(const float* parameters, const BoxTokens& left,
                                               const BoxTokens& right) {
  MixerPass<kWidth, kOutputs, Pair, /*kTraining=*/false> pass;
  std::array<Pair, kBoxTokens> x{};
  for (std::size_t i = 0; i < kBoxTokens; ++i) x[i] = Pair{left[i], right[i], 0, 0};
  std::array<Pair, kOutputs> out;
  pass.Forward(parameters, x, &out);
  std::array<std::array<float, 2>, 2> result{};
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < kOutputs; ++k) result[side][k] = out[k][side];
  }
  return result;
}

[[noreturn]] void RefuseWidth(int width) {
  throw std::invalid_argument(fmt::format("a mixer is 4 or 96 wide, not {}", width));
}

}  // namespace

int MixerParameters(int width, int n_outputs) {
  if (width == 4) return MixerLayout<4>::Parameters(n_outputs);
  if (width == 96) return MixerLayout<96>::Parameters(n_outputs);
  RefuseWidth(width);
}

double MixerOperations(int width, int n_outputs) {
  MixerParameters(width, n_outputs);
  const double tokens = kBoxTokens, hidden = MixerLayout<4>::kTokenHidden;
  const double blocks = MixerLayout<4>::kBlocks;
  const double mlps = blocks * (2 * width * tokens * hidden + 2 * tokens * width * (width / 2));
  const double norms = (2 * blocks + 1) * 5 * tokens * width;
  return tokens * width + mlps + norms + width * n_outputs;
}

Mixer::Mixer(int width, int n_outputs, std::vector<float> parameters)
    : width_(width), n_outputs_(n_outputs), parameters_(std::move(parameters)) {
  const auto wanted = static_cast<std::size_t>(MixerParameters(width, n_outputs));
  if (parameters_.size() != wanted) {
    throw std::invalid_argument(
        fmt::format("must be {} numbers (found {})", wanted, parameters_.size()));
  }
}

std::array<std::array<float, 2>, 2> Mixer::Evaluate(const BoxTokens& left,
                                                    const BoxTokens& right) const {
  const float* p = parameters_.data();
  if (width_ == 4) {
    static const bool kIsWide = WidestInstructionSet() >= InstructionSet::kAvx2;
    MixerAnswers answers{};
    const auto evaluate = kIsWide ? EvaluateMixerFourAvx2 : EvaluateMixerFourSse2;
    evaluate(p, n_outputs_, left, right, &answers);
    return answers;
  }
  return n_outputs_ == 1 ? EvaluateAs<96, 1>(p, left, right) : EvaluateAs<96, 2>(p, left, right);
}

}  // namespace windhover
