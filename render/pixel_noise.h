#pragma once

#include <bit>
#include <cstdint>

namespace windhover {

// Inlined into kernels that are compiled for several processors: integers, and floats whose every
// operation IEEE 754 rounds exactly, so the same bits at any width.

/// A hash of 32 bits. Source: C. Wellons, "Prospecting for Hash Functions", 2018 (lowbias32).
inline __attribute__((always_inline)) std::uint32_t Hash32(std::uint32_t h) {
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return h ^ (h >> 16);
}

/// Normal noise of value `i` of a row, of deviation 1: the sum of eight uniform bytes. Kurtosis
/// -0.15, never beyond 4.9.
inline __attribute__((always_inline)) float PixelNoise(std::uint32_t key0, std::uint32_t key1,
                                                       int i) {
  // Mean and deviation of the sum, whose variance is 8 (2^16 - 1) / 12.
  constexpr float kMean = 1020, kPerSigma = 1 / 209.022f;
  const std::uint32_t h = Hash32((static_cast<std::uint32_t>(i) * 0x9e3779b9u) ^ key0);
  std::uint32_t g = (h ^ key1) * 0x21f0aaadu;
  g = (g ^ (g >> 15)) * 0xd35a2d97u;
  g ^= g >> 15;
  const std::uint32_t pairs =
      (h & 0x00ff00ffu) + ((h >> 8) & 0x00ff00ffu) + (g & 0x00ff00ffu) + ((g >> 8) & 0x00ff00ffu);
  const auto sum = static_cast<std::int32_t>((pairs & 0xffffu) + (pairs >> 16));
  return (static_cast<float>(sum) - kMean) * kPerSigma;
}

/// The square root of `v` >= 0, true to 5e-6 of it: two steps of Newton's method for its inverse.
/// A processor's own square root takes half the time of the noise. Source of the first guess:
/// C. Lomont, "Fast Inverse Square Root", 2003.
inline __attribute__((always_inline)) float QuickRoot(float v) {
  float inverse = std::bit_cast<float>(0x5f375a86 - (std::bit_cast<std::int32_t>(v) >> 1));
  const float half = 0.5f * v;
  inverse *= 1.5f - half * inverse * inverse;
  inverse *= 1.5f - half * inverse * inverse;
  return v * inverse;
}

}  // namespace windhover
