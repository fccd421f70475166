#include "render/warp_kernel.h"

#include <cstring>

namespace windhover {
namespace {

// Two texels side by side, and their sums of products.
using U16x8 = std::uint16_t __attribute__((vector_size(16)));
using U32x8 = std::uint32_t __attribute__((vector_size(32)));
using U32x4 = std::uint32_t __attribute__((vector_size(16)));
using U16x4 = std::uint16_t __attribute__((vector_size(8)));

}  // namespace

// Weights have 8 bits each; 4 of the 32 bits are dropped between the two directions.
__attribute__((target_clones("default", "avx2", "arch=x86-64-v4"))) void WarpPixels(
    const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb) {
  const Texel* texels = window.texels.data();
  const std::ptrdiff_t stride = window.width;
  const std::int32_t du = span.u1 - span.u0, dv = span.v1 - span.v0;
  for (int i = 0; i < span.count; ++i) {
    const std::int32_t u = span.u0 + ((du * i + 8) >> 4), v = span.v0 + ((dv * i + 8) >> 4);
    const Texel* at = texels + (v >> 16) * stride + (u >> 16);
    U16x8 top, bottom;
    std::memcpy(&top, at, sizeof top);
    std::memcpy(&bottom, at + stride, sizeof bottom);
    const auto wu = static_cast<std::uint32_t>(u >> 8) & 255;
    const auto wv = static_cast<std::uint32_t>(v >> 8) & 255;
    const U32x8 column = (__builtin_convertvector(top, U32x8) * (256 - wv) +
                          __builtin_convertvector(bottom, U32x8) * wv + 8) >>
                         4;
    const std::uint32_t wl = 256 - wu;
    const U32x8 weighted = column * U32x8{wl, wl, wl, wl, wu, wu, wu, wu};
    const U32x4 sum = (__builtin_shufflevector(weighted, weighted, 0, 1, 2, 3) +
                       __builtin_shufflevector(weighted, weighted, 4, 5, 6, 7) + 2048) >>
                      12;
    const U16x4 pixel = __builtin_convertvector(sum, U16x4);
    std::memcpy(rgb + 3 * i, &pixel, sizeof pixel);
  }
}

}  // namespace windhover
