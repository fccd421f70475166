#include "render/warp_kernel.h"

#include <immintrin.h>

#include "common/cpu/instruction_set.h"

namespace windhover {
namespace {

constexpr int kMaxSpan = 16;

__m128i Load(const Texel* texels) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(texels));
}

// Two texels side by side: (a · (65535 - w) + b · w) / 65536, at most 2/65536 of white too dark.
__m128i Mix(__m128i a, __m128i b, __m128i weight) {
  const __m128i rest = _mm_xor_si128(weight, _mm_set1_epi16(-1));
  return _mm_add_epi16(_mm_mulhi_epu16(a, rest), _mm_mulhi_epu16(b, weight));
}

__attribute__((target("avx2"))) __m256i Mix2(__m256i a, __m256i b, __m256i weight) {
  const __m256i rest = _mm256_xor_si256(weight, _mm256_set1_epi16(-1));
  return _mm256_add_epi16(_mm256_mulhi_epu16(a, rest), _mm256_mulhi_epu16(b, weight));
}

__attribute__((target("avx2"))) __m256i Pair(__m128i low, __m128i high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

// Where the pixels of a span look: index of the texel above left, and weights in both halves.
struct Places {
  alignas(32) std::int32_t index[kMaxSpan];
  alignas(32) std::uint32_t u_weight[kMaxSpan], v_weight[kMaxSpan];
};

// Of the pixels `i` of a span, eight at a time.
__attribute__((target("avx2"))) __m256i Along(std::int32_t from, std::int32_t to, __m256i i) {
  const __m256i way = _mm256_mullo_epi32(_mm256_set1_epi32(to - from), i);
  return _mm256_add_epi32(_mm256_set1_epi32(from),
                          _mm256_srai_epi32(_mm256_add_epi32(way, _mm256_set1_epi32(8)), 4));
}

__attribute__((target("avx2"))) __m256i WeightTwice(__m256i place) {
  const __m256i weight = _mm256_and_si256(place, _mm256_set1_epi32(65535));
  return _mm256_or_si256(weight, _mm256_slli_epi32(weight, 16));
}

__attribute__((target("avx2"))) void FindPlaces(const WarpSpan& span, int stride, Places* places) {
  for (int k = 0; k < kMaxSpan; k += 8) {
    const __m256i i =
        _mm256_add_epi32(_mm256_set1_epi32(k), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
    const __m256i u = Along(span.u0, span.u1, i), v = Along(span.v0, span.v1, i);
    const __m256i index =
        _mm256_add_epi32(_mm256_mullo_epi32(_mm256_srai_epi32(v, 16), _mm256_set1_epi32(stride)),
                         _mm256_srai_epi32(u, 16));
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->index + k), index);
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->u_weight + k), WeightTwice(u));
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->v_weight + k), WeightTwice(v));
  }
}

__m128i Both(const std::uint32_t* weight) {
  return _mm_set1_epi32(static_cast<std::int32_t>(*weight));
}

}  // namespace

// Two pixels at a time.
__attribute__((target("avx2"))) void WarpPixelsAvx2(const MapWindow& window, const WarpSpan& span,
                                                    std::uint16_t* rgb) {
  Places places;
  FindPlaces(span, window.width, &places);
  const Texel* texels = window.texels.data();
  const std::ptrdiff_t stride = window.width;
  int i = 0;
  for (; i + 1 < span.count; i += 2) {
    const Texel *a = texels + places.index[i], *b = texels + places.index[i + 1];
    const __m256i column = Mix2(Pair(Load(a), Load(b)), Pair(Load(a + stride), Load(b + stride)),
                                Pair(Both(places.v_weight + i), Both(places.v_weight + i + 1)));
    const __m256i pixels = Mix2(column, _mm256_unpackhi_epi64(column, column),
                                Pair(Both(places.u_weight + i), Both(places.u_weight + i + 1)));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb + 3 * i), _mm256_castsi256_si128(pixels));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb + 3 * i + 3),
                     _mm256_extracti128_si256(pixels, 1));
  }
  if (i < span.count) {
    const Texel* at = texels + places.index[i];
    const __m128i column = Mix(Load(at), Load(at + stride), Both(places.v_weight + i));
    const __m128i pixel =
        Mix(column, _mm_unpackhi_epi64(column, column), Both(places.u_weight + i));
    _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb + 3 * i), pixel);
  }
}

// SSE2 alone, which every x86-64 processor has.
void WarpPixelsSse2(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb) {
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

void WarpPixels(const MapWindow& window, const WarpSpan& span, std::uint16_t* rgb) {
  static const bool has_avx2 = WidestInstructionSet() != InstructionSet::kSse2;
  has_avx2 ? WarpPixelsAvx2(window, span, rgb) : WarpPixelsSse2(window, span, rgb);
}

}  // namespace windhover
