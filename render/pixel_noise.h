#pragma once

#include <bit>
#include <cstdint>

#include "common/cpu/instruction_set.h"

namespace windhover {

// Noise of the pixels of a row: a function of a key and the position alone, and the same bits from
// every instruction set.
//
// Values come in blocks of 64, each from 128 bytes that are uniform: position 16 p + k of a block
// is the sum of eight of them with the signs of row p of a Hadamard matrix. A byte serves four
// positions, which do not correlate since rows are orthogonal. A value's kurtosis is -0.15, and so
// is what the squares of two that share their bytes have in common; none is beyond 4.9 sigma.
// Bytes: sixteen xorshift generators of 64 bits, started by SplitMix64. Source: G. Marsaglia,
// "Xorshift RNGs", J. Stat. Softw. 8(14), 2003.

/// Writes `count` normal values of deviation 1.
void FillNoise(std::uint64_t key, int count, float* values);

/// Variances of noise, for light of which 65535 is white.
struct LightNoise {
  float per_light;  ///< Shot noise: variance for each unit of light.
  float of_read;
};

/// Adds noise to `count` values of light, rounded, within 0 to 65535.
void AddNoise(std::uint64_t key, const LightNoise& noise, int count, std::uint16_t* light,
              InstructionSet isa = WidestInstructionSet());

/// The square root of `v` >= 0, true to 7e-4 of it: Newton's method for its inverse, whose guess
/// and one step are fitted to each other. Source: J. Kadlec, "Improving the fast inverse square
/// root", 2010. A processor's own square root takes half the time of the noise.
inline __attribute__((always_inline)) float QuickRoot(float v) {
  const float guess = std::bit_cast<float>(0x5f1ffff9 - (std::bit_cast<std::int32_t>(v) >> 1));
  const float root = v * guess;
  return root * 0.703952253f * (2.38924456f - root * guess);
}

}  // namespace windhover
