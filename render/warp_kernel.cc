#include "render/warp_kernel.h"

#include <array>
#include <cstring>

#include <immintrin.h>

#include "render/warp_patches.h"

namespace windhover {
namespace {

#define WINDHOVER_AVX2 __attribute__((target("avx2")))
#define WINDHOVER_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))

// Weights are of 32767, and so are texels: what 32767 of white is, shifted by this, is 65532.
constexpr int kShift = 14, kHalf = 1 << (kShift - 1);

// --- SSE2, which every x86-64 processor has ------------------------------------------------------

// A texel and its right neighbour, of three planes.
inline __m128i PairsAt(const std::uint16_t* texel, std::ptrdiff_t plane) {
  const auto pair = [texel](std::ptrdiff_t offset) {
    std::int32_t both = 0;
    std::memcpy(&both, texel + offset, sizeof both);
    return both;
  };
  return _mm_set_epi32(0, pair(2 * plane), pair(plane), pair(0));
}

// Of 32767 · 32767, as mulhrs rounds.
inline std::int32_t Product(std::int32_t a, std::int32_t b) { return (a * b + 16384) >> 15; }

template <bool kIsMean>
__m128i PixelOf(const MapWindow& window, std::int32_t u, std::int32_t v, std::int32_t share) {
  const std::int32_t way = (u >> 1) & 32767, down = (v >> 1) & 32767;
  const std::int32_t right = kIsMean ? Product(way, share) : way, left = share - right;
  const std::int32_t below_left = Product(left, down), below_right = Product(right, down);
  const __m128i above = _mm_set1_epi32((left - below_left) | (right - below_right) << 16);
  const __m128i below = _mm_set1_epi32(below_left | below_right << 16);
  const std::uint16_t* texel = window.Row(v >> 16) + (u >> 16);
  const std::ptrdiff_t plane = window.width;
  return _mm_add_epi32(_mm_madd_epi16(PairsAt(texel, plane), above),
                       _mm_madd_epi16(PairsAt(texel + 3 * plane, plane), below));
}

template <bool kIsMean>
void DrawSpan(const MapWindow& window, std::span<const WarpedRow> moments, int x,
              std::uint16_t* rgb) {
  __m128i sums[kWarpCell_px];
  for (__m128i& sum : sums) sum = _mm_set1_epi32(kHalf);
  const auto count = static_cast<std::size_t>(CountAt(moments[0], x));
  for (const WarpedRow& row : moments) {
    const WarpSpan span = SpanAt(row, x);
    for (std::size_t i = 0; i < count; ++i) {
      const int at = static_cast<int>(i);
      sums[i] = _mm_add_epi32(sums[i], PixelOf<kIsMean>(window, span.U(at), span.V(at), row.share));
    }
  }
  rgb += 3 * x;
  for (std::size_t i = 0; i < count; ++i, rgb += 3) {
    const __m128i light = _mm_srli_epi32(sums[i], kShift);
    rgb[0] = static_cast<std::uint16_t>(_mm_extract_epi16(light, 0));
    rgb[1] = static_cast<std::uint16_t>(_mm_extract_epi16(light, 2));
    rgb[2] = static_cast<std::uint16_t>(_mm_extract_epi16(light, 4));
  }
}

template <bool kIsMean>
void RowSse2(const MapWindow& window, std::span<const WarpedRow> moments, std::uint16_t* rgb) {
  for (int x = 0; x < moments[0].width_px; x += kWarpCell_px) {
    DrawSpan<kIsMean>(window, moments, x, rgb);
  }
}

// --- AVX2: eight pixels at a time ----------------------------------------------------------------

constexpr int kAvx2Pixels = 8;

struct EightPixels {
  __m256i word, odd, row;  // Of the patch: half the column, all ones if that is odd.
  __m256i above, below;    // Weights of the texels left (low half) and right.
};

struct EightSums {
  __m256i rgb[3];
};

WINDHOVER_AVX2 inline __attribute__((always_inline)) __m256i EightPlaces(std::int32_t origin,
                                                                         std::int32_t from,
                                                                         std::int32_t to,
                                                                         int first) {
  const __m256i i =
      _mm256_add_epi32(_mm256_set1_epi32(first), _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
  const __m256i way = _mm256_mullo_epi32(_mm256_set1_epi32(to - from), i);
  return _mm256_add_epi32(_mm256_set1_epi32(from - origin),
                          _mm256_srai_epi32(_mm256_add_epi32(way, _mm256_set1_epi32(8)), 4));
}

// `u`, `v`: places relative to the patch.
template <bool kIsMean>
WINDHOVER_AVX2 inline __attribute__((always_inline)) EightPixels Begin(__m256i u, __m256i v,
                                                                       std::int32_t share) {
  const __m256i largest = _mm256_set1_epi32(32767), whole = _mm256_set1_epi32(share);
  __m256i right = _mm256_and_si256(_mm256_srli_epi32(u, 1), largest);
  if (kIsMean) right = _mm256_mulhrs_epi16(right, whole);
  const __m256i across =
      _mm256_or_si256(_mm256_slli_epi32(right, 16), _mm256_sub_epi32(whole, right));
  const __m256i down = _mm256_and_si256(_mm256_srli_epi32(v, 1), largest);
  const __m256i below =
      _mm256_mulhrs_epi16(across, _mm256_or_si256(down, _mm256_slli_epi32(down, 16)));
  return {_mm256_srli_epi32(u, 17), _mm256_srai_epi32(_mm256_slli_epi32(u, 15), 31),
          _mm256_srli_epi32(v, 16), _mm256_sub_epi16(across, below), below};
}

// Of a pair that begins at an odd column, the row one texel on has both in one word.
WINDHOVER_AVX2 inline __attribute__((always_inline)) void AddRow(const std::uint16_t* texels,
                                                                 int plane, __m256i weights,
                                                                 const EightPixels& eight,
                                                                 EightSums* sums) {
  const auto words_at = [&eight](const std::uint16_t* at) __attribute__((target("avx2"))) {
    return _mm256_permutevar8x32_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(at)),
                                       eight.word);
  };
  for (__m256i& sum : sums->rgb) {
    const __m256i pairs = _mm256_blendv_epi8(words_at(texels), words_at(texels + 1), eight.odd);
    sum = _mm256_add_epi32(sum, _mm256_madd_epi16(pairs, weights));
    texels += plane;
  }
}

// What row `r` of the patch weighs: nothing for pixels that it is neither above nor below.
WINDHOVER_AVX2 inline __attribute__((always_inline)) __m256i WeightsOfRow(const EightPixels& eight,
                                                                          int r) {
  const __m256i is_above = _mm256_cmpeq_epi32(eight.row, _mm256_set1_epi32(r));
  const __m256i is_below = _mm256_cmpeq_epi32(eight.row, _mm256_set1_epi32(r - 1));
  return _mm256_or_si256(_mm256_and_si256(is_above, eight.above),
                         _mm256_and_si256(is_below, eight.below));
}

WINDHOVER_AVX2 inline __attribute__((always_inline)) void Put(const EightSums& eight,
                                                              std::uint16_t* rgb) {
  const __m256i red_green =
      _mm256_or_si256(_mm256_srli_epi32(eight.rgb[0], kShift),
                      _mm256_and_si256(_mm256_slli_epi32(eight.rgb[1], 16 - kShift),
                                       _mm256_set1_epi32(static_cast<std::int32_t>(0xffff0000))));
  const __m256i blue = _mm256_srli_epi32(eight.rgb[2], kShift);
  // Two pixels a lane, without the gap after blue.
  const __m256i packing = _mm256_broadcastsi128_si256(
      _mm_setr_epi8(0, 1, 2, 3, 4, 5, 8, 9, 10, 11, 12, 13, -1, -1, -1, -1));
  const __m256i even = _mm256_shuffle_epi8(_mm256_unpacklo_epi32(red_green, blue), packing);
  const __m256i odd = _mm256_shuffle_epi8(_mm256_unpackhi_epi32(red_green, blue), packing);
  const auto put = [](std::uint16_t* to, __m128i pixels) {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), pixels);
  };
  // Each overwrites the two values too many of the one before.
  put(rgb, _mm256_castsi256_si128(even));
  put(rgb + 6, _mm256_castsi256_si128(odd));
  put(rgb + 12, _mm256_extracti128_si256(even, 1));
  put(rgb + 18, _mm256_extracti128_si256(odd, 1));
}

template <bool kIsMean>
WINDHOVER_AVX2 inline __attribute__((always_inline)) void AddEight(const MapWindow& window,
                                                                   const WarpedRow& row, int x,
                                                                   const WarpPatch& patch,
                                                                   EightSums* sums) {
  const WarpSpan span = SpanAt(row, x);
  const int first = x % kWarpCell_px;
  const EightPixels eight =
      Begin<kIsMean>(EightPlaces(patch.column * 65536, span.u0, span.u1, first),
                     EightPlaces(patch.row * 65536, span.v0, span.v1, first), row.share);
  const std::ptrdiff_t stride = 3 * window.width;
  if (patch.n_rows == 2) {
    AddRow(patch.texels, window.width, eight.above, eight, sums);
    AddRow(patch.texels + stride, window.width, eight.below, eight, sums);
    return;
  }
  for (int r = 0; r < patch.n_rows; ++r) {
    AddRow(patch.texels + r * stride, window.width, WeightsOfRow(eight, r), eight, sums);
  }
}

// A whole row, so that what its pixels have in common is worked out once.
template <bool kIsMean>
WINDHOVER_AVX2 void RowAvx2(const MapWindow& window, std::span<const WarpedRow> moments,
                            std::uint16_t* rgb) {
  PatchesOfMoments patches;
  const int width_px = moments[0].width_px;
  const __m256i half = _mm256_set1_epi32(kHalf);
  for (int x = 0, i = 0; x < width_px; x += kWarpCell_px, ++i) {
    const int k = i % kPatches;
    if (k == 0) FindPatches(moments, i, &patches);
    if (width_px - x < kWarpCell_px || !Serve(patches, moments.size(), k, 16)) {
      DrawSpan<kIsMean>(window, moments, x, rgb);
      continue;
    }
    for (std::size_t m = 0; m < moments.size(); ++m) {
      Prefetch(window, PatchAt(window, patches[m], k));
    }
    for (int first = x; first < x + kWarpCell_px; first += kAvx2Pixels) {
      EightSums sums{{half, half, half}};
      for (std::size_t m = 0; m < moments.size(); ++m) {
        AddEight<kIsMean>(window, moments[m], first, PatchAt(window, patches[m], k), &sums);
      }
      Put(sums, rgb + 3 * first);
    }
  }
}

// --- AVX-512: sixteen pixels at a time -----------------------------------------------------------

struct SixteenPixels {
  __m512i columns;  // Of a texel (low half) and its right neighbour.
  __m512i row, above, below;
};

struct SixteenSums {
  __m512i rgb[3];
};

WINDHOVER_AVX512 inline __attribute__((always_inline)) __m512i SixteenPlaces(std::int32_t origin,
                                                                             std::int32_t from,
                                                                             std::int32_t to) {
  const __m512i i = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  const __m512i way = _mm512_mullo_epi32(_mm512_set1_epi32(to - from), i);
  return _mm512_add_epi32(_mm512_set1_epi32(from - origin),
                          _mm512_srai_epi32(_mm512_add_epi32(way, _mm512_set1_epi32(8)), 4));
}

template <bool kIsMean>
WINDHOVER_AVX512 inline __attribute__((always_inline)) SixteenPixels Begin(__m512i u, __m512i v,
                                                                           std::int32_t share) {
  const __m512i largest = _mm512_set1_epi32(32767), whole = _mm512_set1_epi32(share);
  __m512i right = _mm512_and_si512(_mm512_srli_epi32(u, 1), largest);
  if (kIsMean) right = _mm512_mulhrs_epi16(right, whole);
  const __m512i across =
      _mm512_or_si512(_mm512_slli_epi32(right, 16), _mm512_sub_epi32(whole, right));
  const __m512i down = _mm512_and_si512(_mm512_srli_epi32(v, 1), largest);
  const __m512i below =
      _mm512_mulhrs_epi16(across, _mm512_or_si512(down, _mm512_slli_epi32(down, 16)));
  const __m512i next = _mm512_set1_epi32(65536);
  const __m512i column = _mm512_srli_epi32(u, 16);
  return {_mm512_add_epi32(_mm512_or_si512(column, _mm512_slli_epi32(column, 16)), next),
          _mm512_srli_epi32(v, 16), _mm512_sub_epi16(across, below), below};
}

WINDHOVER_AVX512 inline __attribute__((always_inline)) void AddRow(const std::uint16_t* texels,
                                                                   int plane, __m512i weights,
                                                                   __m512i columns,
                                                                   SixteenSums* sums) {
  for (__m512i& sum : sums->rgb) {
    const __m512i pairs = _mm512_permutexvar_epi16(columns, _mm512_loadu_si512(texels));
    sum = _mm512_add_epi32(sum, _mm512_madd_epi16(pairs, weights));
    texels += plane;
  }
}

WINDHOVER_AVX512 inline __attribute__((always_inline)) __m512i WeightsOfRow(
    const SixteenPixels& sixteen, int r) {
  const __mmask16 is_above = _mm512_cmpeq_epi32_mask(sixteen.row, _mm512_set1_epi32(r));
  const __mmask16 is_below = _mm512_cmpeq_epi32_mask(sixteen.row, _mm512_set1_epi32(r - 1));
  return _mm512_mask_mov_epi32(_mm512_maskz_mov_epi32(is_above, sixteen.above), is_below,
                               sixteen.below);
}

// Values `first` to `first` + 31 of sixteen pixels, from (red, green) in the words of one vector
// and (blue, nothing) in the other's.
WINDHOVER_AVX512 inline __attribute__((always_inline)) __m512i PackingFrom(int first) {
  alignas(64) std::uint16_t index[32];
  for (int j = 0; j < 32; ++j) {
    const int pixel = (first + j) / 3 % 16, colour = (first + j) % 3;
    index[j] = static_cast<std::uint16_t>(colour == 2 ? 32 + 2 * pixel : 2 * pixel + colour);
  }
  return _mm512_load_si512(index);
}

WINDHOVER_AVX512 inline __attribute__((always_inline)) void Put(const SixteenSums& sixteen,
                                                                std::uint16_t* rgb) {
  const __m512i red_green =
      _mm512_or_si512(_mm512_srli_epi32(sixteen.rgb[0], kShift),
                      _mm512_and_si512(_mm512_slli_epi32(sixteen.rgb[1], 16 - kShift),
                                       _mm512_set1_epi32(static_cast<std::int32_t>(0xffff0000))));
  const __m512i blue = _mm512_srli_epi32(sixteen.rgb[2], kShift);
  _mm512_storeu_si512(rgb, _mm512_permutex2var_epi16(red_green, PackingFrom(0), blue));
  const __m512i rest = _mm512_permutex2var_epi16(red_green, PackingFrom(32), blue);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(rgb + 32), _mm512_castsi512_si256(rest));
}

template <bool kIsMean>
WINDHOVER_AVX512 inline __attribute__((always_inline)) void AddSixteen(const MapWindow& window,
                                                                       const WarpedRow& row, int x,
                                                                       const WarpPatch& patch,
                                                                       SixteenSums* sums) {
  const WarpSpan span = SpanAt(row, x);
  const SixteenPixels sixteen =
      Begin<kIsMean>(SixteenPlaces(patch.column * 65536, span.u0, span.u1),
                     SixteenPlaces(patch.row * 65536, span.v0, span.v1), row.share);
  const std::ptrdiff_t stride = 3 * window.width;
  if (patch.n_rows == 2) {
    AddRow(patch.texels, window.width, sixteen.above, sixteen.columns, sums);
    AddRow(patch.texels + stride, window.width, sixteen.below, sixteen.columns, sums);
    return;
  }
  for (int r = 0; r < patch.n_rows; ++r) {
    AddRow(patch.texels + r * stride, window.width, WeightsOfRow(sixteen, r), sixteen.columns,
           sums);
  }
}

template <bool kIsMean>
WINDHOVER_AVX512 void RowAvx512(const MapWindow& window, std::span<const WarpedRow> moments,
                                std::uint16_t* rgb) {
  PatchesOfMoments patches;
  const int width_px = moments[0].width_px;
  const __m512i half = _mm512_set1_epi32(kHalf);
  for (int x = 0, i = 0; x < width_px; x += kWarpCell_px, ++i) {
    const int k = i % kPatches;
    if (k == 0) FindPatches(moments, i, &patches);
    if (width_px - x < kWarpCell_px || !Serve(patches, moments.size(), k, 31)) {
      DrawSpan<kIsMean>(window, moments, x, rgb);
      continue;
    }
    SixteenSums sums{{half, half, half}};
    for (std::size_t m = 0; m < moments.size(); ++m) {
      const WarpPatch patch = PatchAt(window, patches[m], k);
      Prefetch(window, patch);
      AddSixteen<kIsMean>(window, moments[m], x, patch, &sums);
    }
    Put(sums, rgb + 3 * x);
  }
}

template <bool kIsMean>
void Warp(const MapWindow& window, std::span<const WarpedRow> moments, std::uint16_t* rgb,
          InstructionSet isa) {
  switch (isa) {
    case InstructionSet::kAvx512:
      return RowAvx512<kIsMean>(window, moments, rgb);
    case InstructionSet::kAvx2:
      return RowAvx2<kIsMean>(window, moments, rgb);
    case InstructionSet::kSse2:
      return RowSse2<kIsMean>(window, moments, rgb);
  }
}

}  // namespace

void WarpRow(const MapWindow& window, const WarpedRow& row, std::uint16_t* rgb,
             InstructionSet isa) {
  Warp<false>(window, {&row, 1}, rgb, isa);
}

void WarpMeanRow(const MapWindow& window, std::span<const WarpedRow> moments, std::uint16_t* rgb,
                 InstructionSet isa) {
  if (moments.size() == 1) return WarpRow(window, moments[0], rgb, isa);
  Warp<true>(window, moments, rgb, isa);
}

}  // namespace windhover
