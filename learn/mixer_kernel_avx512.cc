#include "learn/mixer_kernel_lanes.h"

namespace windhover {

std::unique_ptr<MixerKernel> MakeMixerKernelAvx512(int width, int n_outputs) {
  return MakeMixerKernelLanes<16>(width, n_outputs);
}

}  // namespace windhover
