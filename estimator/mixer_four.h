#pragma once

#include <array>

#include "estimator/mixer.h"

namespace windhover {

/// By box, then by output.
using MixerAnswers = std::array<std::array<float, 2>, 2>;

/// What a mixer of width 4 with `n_outputs` answers to both boxes, in the file of its name. Every
/// instruction set gives the same bits; each must be one that this processor has.
void EvaluateMixerFourSse2(const float* parameters, int n_outputs, const BoxTokens& left,
                           const BoxTokens& right, MixerAnswers* answers);
void EvaluateMixerFourAvx2(const float* parameters, int n_outputs, const BoxTokens& left,
                           const BoxTokens& right, MixerAnswers* answers);

}  // namespace windhover
