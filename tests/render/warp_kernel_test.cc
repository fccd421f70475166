#include "render/warp_kernel.h"

#include <array>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

std::int32_t Below(RandomStream& stream, double limit) {
  return static_cast<std::int32_t>(stream.Uniform(0, limit));
}

// Integers only, so the kernels must agree in every bit.
TEST(WarpPixels, GivesTheSameBitsWithAndWithoutAvx2) {
  if (__builtin_cpu_supports("avx2") == 0) GTEST_SKIP() << "this processor has no AVX2";
  RandomStream stream(1, "warp_kernel_test");
  MapWindow window;
  window.width = 40;
  window.height = 30;
  window.texels.resize(40 * 30 + 1);
  for (Texel& texel : window.texels) {
    for (auto& value : texel) value = static_cast<std::uint16_t>(Below(stream, 65536));
  }
  for (int trial = 0; trial < 2000; ++trial) {
    const WarpSpan span{.u0 = Below(stream, 38 * 65536.0),
                        .v0 = Below(stream, 28 * 65536.0),
                        .u1 = Below(stream, 38 * 65536.0),
                        .v1 = Below(stream, 28 * 65536.0),
                        .count = 1 + Below(stream, 16)};
    std::array<std::uint16_t, 49> wide{}, narrow{};
    WarpPixelsAvx2(window, span, wide.data());
    WarpPixelsSse2(window, span, narrow.data());
    for (int i = 0; i < 3 * span.count; ++i) {
      ASSERT_EQ(wide[static_cast<std::size_t>(i)], narrow[static_cast<std::size_t>(i)]) << i;
    }
  }
}

}  // namespace
}  // namespace windhover
