#include "render/warp_kernel.h"

#include <emmintrin.h>

namespace windhover {
namespace {

// Two texels side by side: (a · (65535 - w) + b · w) / 65536, at most 2/65536 of white too dark.
__m128i Mix(__m128i a, __m128i b, __m128i weight) {
  const __m128i rest = _mm_xor_si128(weight, _mm_set1_epi16(-1));
  return _mm_add_epi16(_mm_mulhi_epu16(a, rest), _mm_mulhi_epu16(b, weight));
}

__m128i Load(const Texel* texels) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(texels));
}

}  // namespace

// SSE2 alone, which every x86-64 processor has.
void WarpPixels(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb) {
  const Texel* texels = window.texels.data();
  const std::ptrdiff_t stride = window.width;
  const std::int32_t du = span.u1 - span.u0, dv = span.v1 - span.v0;
  for (int i = 0; i < span.count; ++i) {
    const std::int32_t u = span.u0 + ((du * i + 8) >> 4), v = span.v0 + ((dv * i + 8) >> 4);
    const Texel* at = texels + (v >> 16) * stride + (u >> 16);
    const __m128i column =
        Mix(Load(at), Load(at + stride), _mm_set1_epi16(static_cast<std::int16_t>(v & 65535)));
    const __m128i pixel = Mix(column, _mm_unpackhi_epi64(column, column),
                              _mm_set1_epi16(static_cast<std::int16_t>(u & 65535)));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb + 3 * i), pixel);
  }
}

}  // namespace windhover
