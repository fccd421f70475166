#include "learn/mixer_kernel_lanes.h"

namespace windhover {

std::unique_ptr<MixerKernel> MakeMixerKernelSse2(int width, int n_outputs) {
  return MakeMixerKernelLanes<4>(width, n_outputs);
}

}  // namespace windhover
