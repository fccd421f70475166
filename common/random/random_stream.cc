#include "common/random/random_stream.h"

#include "common/random/inverse_normal.h"

namespace windhover {

double RandomStream::Normal() {
  // Offset by half a step, so that 0 and 1 cannot occur.
  return InverseNormal((static_cast<double>((*this)() >> 11) + 0.5) * 0x1p-53);
}

}  // namespace windhover
