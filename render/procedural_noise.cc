#include "render/procedural_noise.h"

#include <immintrin.h>

#include "common/cpu/instruction_set.h"

namespace windhover {
namespace {

constexpr std::array<float, kMaxOctaves> Frequencies() {
  std::array<float, kMaxOctaves> frequencies{1};
  for (std::size_t i = 1; i < frequencies.size(); ++i) {
    frequencies[i] = frequencies[i - 1] * 2.03f;  // Not 2, so that the lattices do not line up.
  }
  return frequencies;
}
alignas(32) constexpr std::array<float, kMaxOctaves> kFrequencies = Frequencies();

// WholePart, as a whole number.
__attribute__((target("avx2"))) __m256i WholePart8(__m256 x) {
  const __m256i truncated = _mm256_cvttps_epi32(x);
  const __m256 is_above = _mm256_cmp_ps(_mm256_cvtepi32_ps(truncated), x, _CMP_GT_OQ);
  return _mm256_add_epi32(truncated, _mm256_castps_si256(is_above));
}

// CellHash of x * 0x9e3779b9 and y * 0x85ebca6b + seed * 0xc2b2ae35.
__attribute__((target("avx2"))) __m256 Hash8(__m256i x, __m256i y) {
  __m256i h = _mm256_xor_si256(x, y);
  h = _mm256_xor_si256(h, _mm256_srli_epi32(h, 16));
  h = _mm256_mullo_epi32(h, _mm256_set1_epi32(0x7feb352d));
  h = _mm256_xor_si256(h, _mm256_srli_epi32(h, 15));
  h = _mm256_mullo_epi32(h, _mm256_set1_epi32(static_cast<int>(0x846ca68bu)));
  h = _mm256_srli_epi32(_mm256_xor_si256(h, _mm256_srli_epi32(h, 16)), 8);
  return _mm256_mul_ps(_mm256_cvtepi32_ps(h), _mm256_set1_ps(0x1p-24f));
}

// SmoothStep(0, 1, t) of t in 0..1.
__attribute__((target("avx2"))) __m256 Smooth8(__m256 t) {
  const __m256 rest = _mm256_sub_ps(_mm256_set1_ps(3), _mm256_add_ps(t, t));
  return _mm256_mul_ps(_mm256_mul_ps(t, t), rest);
}

__attribute__((target("avx2"))) __m256 Mix8(__m256 a, __m256 b, __m256 t) {
  return _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), t));
}

}  // namespace

void NoiseOctavesScalar(float x, float y, int octaves, float footprint, std::uint32_t seed,
                        NoiseOctaves* out) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(octaves); ++i) {
    const float frequency = kFrequencies[i];
    out->fade[i] = 1 - SmoothStep(0.25f, 1.0f, footprint * frequency);
    if (out->fade[i] <= 0) return;
    out->noise[i] = ValueNoise(x * frequency, y * frequency, seed + static_cast<unsigned>(i));
  }
}

__attribute__((target("avx2"))) void NoiseOctavesAvx2(float x, float y, float footprint,
                                                      std::uint32_t seed, NoiseOctaves* out) {
  const __m256 one = _mm256_set1_ps(1), frequency = _mm256_load_ps(kFrequencies.data());
  const __m256 u = _mm256_mul_ps(_mm256_set1_ps(x), frequency);
  const __m256 v = _mm256_mul_ps(_mm256_set1_ps(y), frequency);
  const __m256i column = WholePart8(u), row = WholePart8(v);
  const __m256 tx = Smooth8(_mm256_sub_ps(u, _mm256_cvtepi32_ps(column)));
  const __m256 ty = Smooth8(_mm256_sub_ps(v, _mm256_cvtepi32_ps(row)));
  const __m256i x_prime = _mm256_set1_epi32(static_cast<int>(0x9e3779b9u));
  const __m256i y_prime = _mm256_set1_epi32(static_cast<int>(0x85ebca6bu));
  const __m256i seeds = _mm256_add_epi32(_mm256_set1_epi32(static_cast<int>(seed)),
                                         _mm256_set_epi32(7, 6, 5, 4, 3, 2, 1, 0));
  const __m256i x0 = _mm256_mullo_epi32(column, x_prime), x1 = _mm256_add_epi32(x0, x_prime);
  const __m256i y0 =
      _mm256_add_epi32(_mm256_mullo_epi32(row, y_prime),
                       _mm256_mullo_epi32(seeds, _mm256_set1_epi32(static_cast<int>(0xc2b2ae35u))));
  const __m256i y1 = _mm256_add_epi32(y0, y_prime);
  const __m256 near = _mm256_mul_ps(Mix8(Hash8(x0, y0), Hash8(x1, y0), tx), _mm256_sub_ps(one, ty));
  const __m256 far = _mm256_mul_ps(Mix8(Hash8(x0, y1), Hash8(x1, y1), tx), ty);
  _mm256_store_ps(out->noise.data(), _mm256_add_ps(near, far));
  const __m256 detail = _mm256_mul_ps(_mm256_set1_ps(footprint), frequency);
  const __m256 t =
      _mm256_div_ps(_mm256_sub_ps(detail, _mm256_set1_ps(0.25f)), _mm256_set1_ps(1.0f - 0.25f));
  const __m256 clamped = _mm256_min_ps(_mm256_max_ps(t, _mm256_setzero_ps()), one);
  _mm256_store_ps(out->fade.data(), _mm256_sub_ps(one, Smooth8(clamped)));
}

float FractalNoise(float x, float y, int octaves, float footprint, std::uint32_t seed) {
  static const bool has_avx2 = WidestInstructionSet() >= InstructionSet::kAvx2;
  if (footprint >= 1) return 0.5f;
  NoiseOctaves all;
  has_avx2 ? NoiseOctavesAvx2(x, y, footprint, seed, &all)
           : NoiseOctavesScalar(x, y, octaves, footprint, seed, &all);
  float sum = 0, weight = 0.5f;
  for (std::size_t i = 0; i < static_cast<std::size_t>(octaves); ++i) {
    if (all.fade[i] <= 0) break;  // Rest of the series: weight / 2 + weight / 4 + …
    sum += weight * (0.5f + all.fade[i] * (all.noise[i] - 0.5f));
    weight *= 0.5f;
  }
  return sum + weight;
}

}  // namespace windhover
