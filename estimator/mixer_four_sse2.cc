#include "estimator/mixer_four_lanes.h"

namespace windhover {

void EvaluateMixerFourSse2(const float* parameters, int n_outputs, const BoxTokens& left,
                           const BoxTokens& right, MixerAnswers* answers) {
  MixerFourLanes<1>::Evaluate(parameters, n_outputs, left, right, answers);
}

}  // namespace windhover
