#include "render/pixel_noise.h"

#include <algorithm>
#include <array>

#include <immintrin.h>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

#define WINDHOVER_AVX512 __attribute__((target("avx512f,avx512bw,avx512dq,avx512vl")))

constexpr int kBlock = 64, kLanes = 16;
// The variance of the sum of eight bytes is 8 (2^16 - 1) / 12.
constexpr float kPerSigma = 1 / 209.022f;

struct Generators {
  explicit Generators(std::uint64_t key) {
    RandomStream seeds(key, "pixel noise");
    for (std::uint64_t& state : h) state = seeds() | 1;  // None may be 0.
    for (std::uint64_t& state : g) state = seeds() | 1;
  }

  alignas(64) std::array<std::uint64_t, kLanes / 2> h, g;
};

// What the eight bytes of h and g in a lane add up to, with four patterns of signs.
using BlockSums = std::array<std::int32_t, kBlock>;

// Compiled for each instruction set.
inline __attribute__((always_inline)) void Step(std::array<std::uint64_t, kLanes / 2>* states) {
  for (std::uint64_t& x : *states) {
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
  }
}

inline __attribute__((always_inline)) void NextSums(Generators* generators, BlockSums* sums) {
  Step(&generators->h);
  Step(&generators->g);
  const auto h = std::bit_cast<std::array<std::uint32_t, kLanes>>(generators->h);
  const auto g = std::bit_cast<std::array<std::uint32_t, kLanes>>(generators->g);
  for (std::size_t k = 0; k < kLanes; ++k) {
    const auto byte = [](std::uint32_t word, int i) {
      return static_cast<std::int32_t>((word >> (8 * i)) & 255u);
    };
    const std::int32_t h01 = byte(h[k], 0) + byte(h[k], 1), h23 = byte(h[k], 2) + byte(h[k], 3);
    const std::int32_t g01 = byte(g[k], 0) + byte(g[k], 1), g23 = byte(g[k], 2) + byte(g[k], 3);
    const std::int32_t d01 = byte(h[k], 0) - byte(h[k], 1) + byte(g[k], 0) - byte(g[k], 1);
    const std::int32_t d23 = byte(h[k], 2) - byte(h[k], 3) + byte(g[k], 2) - byte(g[k], 3);
    (*sums)[k] = h01 + h23 - g01 - g23;
    (*sums)[kLanes + k] = d01 + d23;
    (*sums)[2 * kLanes + k] = h01 + g01 - h23 - g23;
    (*sums)[3 * kLanes + k] = d01 - d23;
  }
}

inline __attribute__((always_inline)) std::uint16_t Noisy(std::uint16_t value, std::int32_t sum,
                                                          const LightNoise& noise) {
  // Adding it leaves an integer, rounded to even, in the low bits of a float.
  constexpr float kRounder = 12582912;
  const auto light = static_cast<float>(static_cast<std::int32_t>(value));
  const float sigma = QuickRoot(light * noise.per_light + noise.of_read);
  const float noisy = light + sigma * static_cast<float>(sum);
  const std::int32_t rounded =
      std::bit_cast<std::int32_t>(noisy + kRounder) - std::bit_cast<std::int32_t>(kRounder);
  const std::int32_t positive = rounded < 0 ? 0 : rounded;
  return static_cast<std::uint16_t>(positive > 65535 ? 65535 : positive);
}

inline __attribute__((always_inline)) void AddNoiseTo(Generators* generators,
                                                      const LightNoise& noise, int count,
                                                      std::uint16_t* light) {
  BlockSums sums;
  for (int i = 0; i < count; i += kBlock) {
    NextSums(generators, &sums);
    const int n = count - i < kBlock ? count - i : kBlock;
    for (int k = 0; k < n; ++k) {
      light[i + k] = Noisy(light[i + k], sums[static_cast<std::size_t>(k)], noise);
    }
  }
}

void AddNoiseSse2(Generators* generators, const LightNoise& noise, int count,
                  std::uint16_t* light) {
  AddNoiseTo(generators, noise, count, light);
}

__attribute__((target("avx2"))) void AddNoiseAvx2(Generators* generators, const LightNoise& noise,
                                                  int count, std::uint16_t* light) {
  AddNoiseTo(generators, noise, count, light);
}

// --- AVX-512 -------------------------------------------------------------------------------------

WINDHOVER_AVX512 inline __m512i Stepped(__m512i x) {
  x = _mm512_xor_si512(x, _mm512_slli_epi64(x, 13));
  x = _mm512_xor_si512(x, _mm512_srli_epi64(x, 7));
  return _mm512_xor_si512(x, _mm512_slli_epi64(x, 17));
}

struct WideSums {
  __m512i of_pattern[4];
};

WINDHOVER_AVX512 inline WideSums SumsOf(__m512i h, __m512i g) {
  const __m512i sum8 = _mm512_set1_epi8(1), difference8 = _mm512_set1_epi16(-255);  // 1, -1
  const __m512i sum16 = _mm512_set1_epi16(1), difference16 = _mm512_set1_epi32(-65535);
  const __m512i h_sums = _mm512_maddubs_epi16(h, sum8), g_sums = _mm512_maddubs_epi16(g, sum8);
  const __m512i both = _mm512_add_epi16(h_sums, g_sums);
  const __m512i differences =
      _mm512_add_epi16(_mm512_maddubs_epi16(h, difference8), _mm512_maddubs_epi16(g, difference8));
  return {_mm512_madd_epi16(_mm512_sub_epi16(h_sums, g_sums), sum16),
          _mm512_madd_epi16(differences, sum16), _mm512_madd_epi16(both, difference16),
          _mm512_madd_epi16(differences, difference16)};
}

WINDHOVER_AVX512 inline __m512i Noisy(__m512i value, __m512i sum, __m512 per_light,
                                      __m512 of_read) {
  const __m512 light = _mm512_cvtepi32_ps(value);
  const __m512 variance = _mm512_add_ps(_mm512_mul_ps(light, per_light), of_read);
  // QuickRoot, operation by operation.
  const __m512 guess = _mm512_castsi512_ps(_mm512_sub_epi32(
      _mm512_set1_epi32(0x5f1ffff9), _mm512_srai_epi32(_mm512_castps_si512(variance), 1)));
  const __m512 root = _mm512_mul_ps(variance, guess);
  const __m512 sigma =
      _mm512_mul_ps(_mm512_mul_ps(root, _mm512_set1_ps(0.703952253f)),
                    _mm512_sub_ps(_mm512_set1_ps(2.38924456f), _mm512_mul_ps(root, guess)));
  const __m512 noisy = _mm512_add_ps(light, _mm512_mul_ps(sigma, _mm512_cvtepi32_ps(sum)));
  return _mm512_max_epi32(_mm512_cvtps_epi32(noisy), _mm512_setzero_si512());
}

WINDHOVER_AVX512 void AddNoiseAvx512(Generators* generators, const LightNoise& noise, int count,
                                     std::uint16_t* light) {
  const __m512 per_light = _mm512_set1_ps(noise.per_light), of_read = _mm512_set1_ps(noise.of_read);
  __m512i h = _mm512_load_si512(generators->h.data());
  __m512i g = _mm512_load_si512(generators->g.data());
  for (int i = 0; i < count; i += kBlock) {
    h = Stepped(h);
    g = Stepped(g);
    const WideSums sums = SumsOf(h, g);
    const int rest = std::min(count - i, kBlock);
    std::uint16_t* at = light + i;
    if (rest == kBlock) {
      for (int p = 0; p < 4; ++p, at += kLanes) {
        const __m512i value = _mm512_cvtepu16_epi32(_mm256_loadu_epi16(at));
        const __m512i noisy = Noisy(value, sums.of_pattern[p], per_light, of_read);
        _mm256_storeu_epi16(at, _mm512_cvtusepi32_epi16(noisy));
      }
      continue;
    }
    for (int p = 0; p < 4; ++p, at += kLanes) {
      const int n = std::clamp(rest - p * kLanes, 0, kLanes);
      const auto present = static_cast<__mmask16>((1u << n) - 1);
      const __m512i value = _mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(present, at));
      const __m512i noisy = Noisy(value, sums.of_pattern[p], per_light, of_read);
      _mm256_mask_storeu_epi16(at, present, _mm512_cvtusepi32_epi16(noisy));
    }
  }
}

}  // namespace

void FillNoise(std::uint64_t key, int count, float* values) {
  Generators generators(key);
  BlockSums sums;
  for (int i = 0; i < count; i += kBlock) {
    NextSums(&generators, &sums);
    const int n = std::min(count - i, kBlock);
    for (int k = 0; k < n; ++k) {
      values[i + k] = kPerSigma * static_cast<float>(sums[static_cast<std::size_t>(k)]);
    }
  }
}

void AddNoise(std::uint64_t key, const LightNoise& noise, int count, std::uint16_t* light,
              InstructionSet isa) {
  Generators generators(key);
  // Of a sum of bytes.
  const LightNoise of_sum{noise.per_light * (kPerSigma * kPerSigma),
                          noise.of_read * (kPerSigma * kPerSigma)};
  switch (isa) {
    case InstructionSet::kAvx512:
      return AddNoiseAvx512(&generators, of_sum, count, light);
    case InstructionSet::kAvx2:
      return AddNoiseAvx2(&generators, of_sum, count, light);
    case InstructionSet::kSse2:
      return AddNoiseSse2(&generators, of_sum, count, light);
  }
}

}  // namespace windhover
