#include "learn/pcm_batch.h"

#include "estimator/mixer_pass.h"

namespace windhover {

MixerKernel::Tokens TokensOfBlock(const std::vector<ActiveSample>& samples, std::size_t begin) {
  MixerKernel::Tokens x{};
  for (std::size_t i = 0; i < kPairs && begin + i < samples.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t k = 0; k < kBoxTokens; ++k) {
        x[k][2 * i + side] = samples[begin + i].tokens[side][k];
      }
    }
  }
  return x;
}

}  // namespace windhover
