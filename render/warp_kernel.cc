#include "render/warp_kernel.h"

#include <algorithm>

#include <immintrin.h>

namespace windhover {
namespace {

#define WINDHOVER_AVX2 __attribute__((target("avx2")))
#define WINDHOVER_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))

// Up to 16 pixels along a row.
struct Span {
  std::int32_t u0, v0, u1, v1;
  int count;

  std::int32_t U(int i) const { return u0 + (((u1 - u0) * i + 8) >> 4); }
  std::int32_t V(int i) const { return v0 + (((v1 - v0) * i + 8) >> 4); }
};

__m128i Load(const Texel* texels) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(texels));
}

// Two texels side by side: (a · (65535 - w) + b · w) / 65536.
__m128i Mix(__m128i a, __m128i b, __m128i weight) {
  const __m128i rest = _mm_xor_si128(weight, _mm_set1_epi16(-1));
  return _mm_add_epi16(_mm_mulhi_epu16(a, rest), _mm_mulhi_epu16(b, weight));
}

// --- SSE2, which every x86-64 processor has ------------------------------------------------------

void Put(__m128i pixel, std::uint16_t* rgb) {
  _mm_storel_epi64(reinterpret_cast<__m128i*>(rgb), pixel);
}

void SpanSse2(const MapWindow& window, const Span& span, std::uint16_t* rgb) {
  for (int i = 0; i < span.count; ++i) {
    const std::int32_t u = span.U(i), v = span.V(i);
    const Texel* at = window.texels.data() + std::ptrdiff_t{v >> 16} * window.width + (u >> 16);
    const __m128i column = Mix(Load(at), Load(at + window.width),
                               _mm_set1_epi16(static_cast<std::int16_t>(v & 65535)));
    Put(Mix(column, _mm_unpackhi_epi64(column, column),
            _mm_set1_epi16(static_cast<std::int16_t>(u & 65535))),
        rgb + 3 * i);
  }
}

// --- AVX2: two pixels at a time ------------------------------------------------------------------

WINDHOVER_AVX2 __m256i Mix2(__m256i a, __m256i b, __m256i weight) {
  const __m256i rest = _mm256_xor_si256(weight, _mm256_set1_epi16(-1));
  return _mm256_add_epi16(_mm256_mulhi_epu16(a, rest), _mm256_mulhi_epu16(b, weight));
}

WINDHOVER_AVX2 __m256i Pair(__m128i low, __m128i high) {
  return _mm256_inserti128_si256(_mm256_castsi128_si256(low), high, 1);
}

__m128i Both(const std::uint32_t* weight) {
  return _mm_set1_epi32(static_cast<std::int32_t>(*weight));
}

// Where the pixels of a span look: the texel above left, and weights in both halves.
struct Places {
  alignas(32) std::int32_t texel[kWarpCell_px];
  alignas(32) std::uint32_t u_weight[kWarpCell_px], v_weight[kWarpCell_px];
};

WINDHOVER_AVX2 __m256i WeightTwice(__m256i place) {
  const __m256i weight = _mm256_and_si256(place, _mm256_set1_epi32(65535));
  return _mm256_or_si256(weight, _mm256_slli_epi32(weight, 16));
}

WINDHOVER_AVX2 __m256i Along(std::int32_t from, std::int32_t to, __m256i i) {
  const __m256i way = _mm256_mullo_epi32(_mm256_set1_epi32(to - from), i);
  return _mm256_add_epi32(_mm256_set1_epi32(from),
                          _mm256_srai_epi32(_mm256_add_epi32(way, _mm256_set1_epi32(8)), 4));
}

WINDHOVER_AVX2 void FindPlaces(const Span& span, int stride, Places* places) {
  for (int k = 0; k < kWarpCell_px; k += 8) {
    const __m256i i =
        _mm256_add_epi32(_mm256_set1_epi32(k), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
    const __m256i u = Along(span.u0, span.u1, i), v = Along(span.v0, span.v1, i);
    const __m256i rows = _mm256_mullo_epi32(_mm256_srai_epi32(v, 16), _mm256_set1_epi32(stride));
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->u_weight + k), WeightTwice(u));
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->v_weight + k), WeightTwice(v));
    _mm256_store_si256(reinterpret_cast<__m256i*>(places->texel + k),
                       _mm256_add_epi32(rows, _mm256_srai_epi32(u, 16)));
  }
}

WINDHOVER_AVX2 void SpanAvx2(const MapWindow& window, const Span& span, std::uint16_t* rgb) {
  Places places;
  FindPlaces(span, window.width, &places);
  const Texel* texels = window.texels.data();
  const std::ptrdiff_t stride = window.width;
  int i = 0;
  for (; i + 1 < span.count; i += 2) {
    const Texel *a = texels + places.texel[i], *b = texels + places.texel[i + 1];
    const __m256i column = Mix2(Pair(Load(a), Load(b)), Pair(Load(a + stride), Load(b + stride)),
                                Pair(Both(places.v_weight + i), Both(places.v_weight + i + 1)));
    const __m256i pixels = Mix2(column, _mm256_unpackhi_epi64(column, column),
                                Pair(Both(places.u_weight + i), Both(places.u_weight + i + 1)));
    Put(_mm256_castsi256_si128(pixels), rgb + 3 * i);
    Put(_mm256_extracti128_si256(pixels, 1), rgb + 3 * i + 3);
  }
  if (i < span.count) {
    SpanSse2(window, {span.U(i), span.V(i), 0, 0, 1}, rgb + 3 * i);
  }
}

// --- AVX-512: sixteen pixels at a time, their texels picked from whole rows of them --------------

// The places of 16 pixels relative to the texel (column, row), and how many rows they need.
struct Patch {
  int column, row, n_rows;
};

constexpr int kPatchColumns = 16, kMaxPatchRows = 6;

// Whether a patch serves the span. Places are in a straight line, so the ends bound them.
bool FindPatch(const MapWindow& window, const Span& span, Patch* patch) {
  if (span.count != kWarpCell_px || window.width < kPatchColumns) return false;
  const auto [left, right] = std::minmax({span.U(0) >> 16, span.U(kWarpCell_px - 1) >> 16});
  const auto [top, bottom] = std::minmax({span.V(0) >> 16, span.V(kWarpCell_px - 1) >> 16});
  *patch = {std::min(left, window.width - kPatchColumns), top, bottom - top + 2};
  return right + 2 - patch->column <= kPatchColumns && patch->n_rows <= kMaxPatchRows;
}

// Eight pixels: which texel of a row of the patch, which row, the weights of the texel to the right
// and of the row below, and the sums over rows of the texels left and right.
struct EightPixels {
  __m512i column, row, u_weight, v_weight, left, right;
};

// Each of eight 32-bit weights four times, for the four values of a texel.
WINDHOVER_AVX512 inline __m512i FourTimes(__m256i weight) {
  const __m512i low = _mm512_set4_epi32(0x09080908, 0x09080908, 0x01000100, 0x01000100);
  return _mm512_shuffle_epi8(_mm512_cvtepu32_epi64(weight), low);
}

WINDHOVER_AVX512 inline __m512i Complement(__m512i weight) {
  return _mm512_xor_si512(weight, _mm512_set1_epi16(-1));
}

// `u`, `v`: places relative to the patch.
WINDHOVER_AVX512 inline EightPixels Begin(__m256i u, __m256i v) {
  return {_mm512_cvtepu32_epi64(_mm256_srli_epi32(u, 16)),
          _mm512_cvtepu32_epi64(_mm256_srli_epi32(v, 16)),
          FourTimes(u),
          FourTimes(v),
          _mm512_setzero_si512(),
          _mm512_setzero_si512()};
}

WINDHOVER_AVX512 inline void AddRow(__m512i texels0, __m512i texels8, __m512i weight,
                                    EightPixels* eight) {
  const __m512i next = _mm512_add_epi64(eight->column, _mm512_set1_epi64(1));
  const __m512i left = _mm512_permutex2var_epi64(texels0, eight->column, texels8);
  const __m512i right = _mm512_permutex2var_epi64(texels0, next, texels8);
  eight->left = _mm512_add_epi16(eight->left, _mm512_mulhi_epu16(left, weight));
  eight->right = _mm512_add_epi16(eight->right, _mm512_mulhi_epu16(right, weight));
}

// What row `r` of the patch weighs: nothing for pixels that it is neither above nor below.
WINDHOVER_AVX512 inline __m512i WeightOfRow(const EightPixels& eight, int r) {
  const __mmask8 is_above = _mm512_cmpeq_epi64_mask(eight.row, _mm512_set1_epi64(r));
  const __mmask8 is_below = _mm512_cmpeq_epi64_mask(eight.row, _mm512_set1_epi64(r - 1));
  return _mm512_mask_mov_epi64(_mm512_maskz_mov_epi64(is_above, Complement(eight.v_weight)),
                               is_below, eight.v_weight);
}

WINDHOVER_AVX512 inline void AddRows(const Texel* texels, std::ptrdiff_t stride, int n_rows,
                                     EightPixels* first, EightPixels* second) {
  for (int r = 0; r < n_rows; ++r, texels += stride) {
    const __m512i texels0 = _mm512_loadu_si512(texels), texels8 = _mm512_loadu_si512(texels + 8);
    AddRow(texels0, texels8, WeightOfRow(*first, r), first);
    AddRow(texels0, texels8, WeightOfRow(*second, r), second);
  }
}

WINDHOVER_AVX512 inline void AddTwoRows(const Texel* texels, std::ptrdiff_t stride,
                                        EightPixels* first, EightPixels* second) {
  const __m512i above0 = _mm512_loadu_si512(texels), above8 = _mm512_loadu_si512(texels + 8);
  AddRow(above0, above8, Complement(first->v_weight), first);
  AddRow(above0, above8, Complement(second->v_weight), second);
  texels += stride;
  const __m512i below0 = _mm512_loadu_si512(texels), below8 = _mm512_loadu_si512(texels + 8);
  AddRow(below0, below8, first->v_weight, first);
  AddRow(below0, below8, second->v_weight, second);
}

WINDHOVER_AVX512 inline void Put(const EightPixels& eight, std::uint16_t* rgb) {
  const __m512i packing = _mm512_set_epi16(0, 0, 0, 0, 0, 0, 0, 0, 30, 29, 28, 26, 25, 24, 22, 21,
                                           20, 18, 17, 16, 14, 13, 12, 10, 9, 8, 6, 5, 4, 2, 1, 0);
  const __m512i pixels =
      _mm512_add_epi16(_mm512_mulhi_epu16(eight.left, Complement(eight.u_weight)),
                       _mm512_mulhi_epu16(eight.right, eight.u_weight));
  _mm512_mask_storeu_epi16(rgb, 0xffffff, _mm512_permutexvar_epi16(packing, pixels));
}

// The 16 places from `from` towards `to`, from `origin` on.
WINDHOVER_AVX512 inline __m512i PlacesFrom(std::int32_t origin, std::int32_t from,
                                           std::int32_t to) {
  const __m512i i = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  const __m512i way = _mm512_mullo_epi32(_mm512_set1_epi32(to - from), i);
  return _mm512_add_epi32(_mm512_set1_epi32(from - origin),
                          _mm512_srai_epi32(_mm512_add_epi32(way, _mm512_set1_epi32(8)), 4));
}

WINDHOVER_AVX512 void SpanAvx512(const MapWindow& window, const Span& span, std::uint16_t* rgb) {
  Patch patch;
  if (!FindPatch(window, span, &patch)) return SpanAvx2(window, span, rgb);
  const __m512i u = PlacesFrom(patch.column * 65536, span.u0, span.u1);
  const __m512i v = PlacesFrom(patch.row * 65536, span.v0, span.v1);
  EightPixels first = Begin(_mm512_castsi512_si256(u), _mm512_castsi512_si256(v));
  EightPixels second = Begin(_mm512_extracti64x4_epi64(u, 1), _mm512_extracti64x4_epi64(v, 1));
  const Texel* texels =
      window.texels.data() + std::ptrdiff_t{patch.row} * window.width + patch.column;
  if (patch.n_rows == 2) {
    AddTwoRows(texels, window.width, &first, &second);
  } else {
    AddRows(texels, window.width, patch.n_rows, &first, &second);
  }
  Put(first, rgb);
  Put(second, rgb + 24);
}

using DrawSpan = void (*)(const MapWindow&, const Span&, std::uint16_t*);

DrawSpan DrawSpanOf(InstructionSet isa) {
  if (isa == InstructionSet::kAvx512) return SpanAvx512;
  return isa == InstructionSet::kAvx2 ? SpanAvx2 : SpanSse2;
}

}  // namespace

void WarpRow(const MapWindow& window, const WarpedRow& row, std::uint16_t* rgb,
             InstructionSet isa) {
  const DrawSpan draw_span = DrawSpanOf(isa);
  for (int i = 0, x = 0; x < row.width_px; ++i, x += kWarpCell_px) {
    const int count = std::min(kWarpCell_px, row.width_px - x);
    draw_span(window, {row.u[i], row.v[i], row.u[i + 1], row.v[i + 1], count}, rgb + x * 3);
  }
}

}  // namespace windhover
