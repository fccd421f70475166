#include "learn/mixer_kernel.h"

#include "learn/mixer_kernel_lanes.h"

namespace windhover {

std::unique_ptr<MixerKernel> MakeMixerKernel(int width, int n_outputs,
                                             InstructionSet instructions) {
  MixerParameters(width, n_outputs);  // Throws for a width that is none.
  switch (instructions) {
    case InstructionSet::kAvx512:
      return MakeMixerKernelAvx512(width, n_outputs);
    case InstructionSet::kAvx2:
      return MakeMixerKernelAvx2(width, n_outputs);
    case InstructionSet::kSse2:
      break;
  }
  return MakeMixerKernelSse2(width, n_outputs);
}

}  // namespace windhover
