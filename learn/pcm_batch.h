#pragma once

#include <vector>

#include "learn/mixer_kernel.h"
#include "learn/pcm_score.h"

namespace windhover {

/// A sample on its way through the stages.
struct ActiveSample {
  CorrectableBoxes boxes;
  BoxTokens tokens[2];
  float label_m;
  bool is_hard = false;

  explicit ActiveSample(const PcmSample& sample) : boxes(sample.boxes), label_m(sample.label_m) {
    Retokenise();
  }
  /// After the boxes have changed.
  void Retokenise() {
    for (int side = 0; side < 2; ++side) tokens[side] = TokensOf(boxes, side);
  }
};

/// Stereo pairs that a kernel takes at once.
inline constexpr std::size_t kPairs = MixerKernel::kBoxes / 2;

/// Tokens of kPairs samples from `begin` on, left and right in turn; zeros beyond the end.
MixerKernel::Tokens TokensOfBlock(const std::vector<ActiveSample>& samples, std::size_t begin);

}  // namespace windhover
