#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace windhover {

// Textures without images: functions of position alone, the same on every machine.

/// Largest whole number not above `x`; |x| < 2^31. (std::floor is a call without SSE4.1.)
inline float WholePart(float x) {
  const auto truncated = static_cast<float>(static_cast<std::int32_t>(x));
  return truncated > x ? truncated - 1 : truncated;
}

/// A hash of lattice cell (x, y), 0 to 1. Source: C. Wellons, "Prospecting for Hash Functions",
/// 2018 (lowbias32).
inline float CellHash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
  std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b9u ^
                    (static_cast<std::uint32_t>(y) * 0x85ebca6bu + seed * 0xc2b2ae35u);
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  return static_cast<float>((h ^ (h >> 16)) >> 8) * 0x1p-24f;
}

/// 0 below `low`, 1 above `high`, smooth between.
inline float SmoothStep(float low, float high, float x) {
  const float t = std::min(std::max((x - low) / (high - low), 0.0f), 1.0f);
  return t * t * (3 - 2 * t);
}

/// Smooth noise with features of size 1, 0 to 1, mean 0.5.
inline float ValueNoise(float x, float y, std::uint32_t seed) {
  const float fx = WholePart(x), fy = WholePart(y);
  const auto ix = static_cast<std::int32_t>(fx), iy = static_cast<std::int32_t>(fy);
  const float tx = SmoothStep(0, 1, x - fx), ty = SmoothStep(0, 1, y - fy);
  const float a = CellHash(ix, iy, seed), b = CellHash(ix + 1, iy, seed);
  const float c = CellHash(ix, iy + 1, seed), d = CellHash(ix + 1, iy + 1, seed);
  return (a + (b - a) * tx) * (1 - ty) + (c + (d - c) * tx) * ty;
}

/// Most octaves that FractalNoise adds up.
inline constexpr int kMaxOctaves = 8;

/// Octaves of ValueNoise from features of size 1 down to `footprint`, 0 to 1: finer ones, which
/// would alias, fade to their mean. At most kMaxOctaves.
float FractalNoise(float x, float y, int octaves, float footprint, std::uint32_t seed);

/// The noise of each octave at (x, y), and how much of it there is.
struct NoiseOctaves {
  alignas(32) std::array<float, kMaxOctaves> noise, fade;
};

/// The same bits, one octave after the other and eight at a time; FractalNoise chooses.
void NoiseOctavesScalar(float x, float y, int octaves, float footprint, std::uint32_t seed,
                        NoiseOctaves* out);
void NoiseOctavesAvx2(float x, float y, float footprint, std::uint32_t seed, NoiseOctaves* out);

/// Share of [x - width / 2, x + width / 2] in which a stripe is on: each period begins with a
/// stripe `duty` of it long.
inline float StripeCoverage(float x, float period, float duty, float width) {
  const auto integral = [duty](float t) {  // Of the stripes, from 0 to t, in periods.
    const float whole = WholePart(t);
    return whole * duty + std::min(t - whole, duty);
  };
  const float half = std::max(width, 1e-6f * period) / (2 * period);
  const float t = x / period;
  return (integral(t + half) - integral(t - half)) / (2 * half);
}

/// Share of [x - width / 2, x + width / 2] that lies in [low, high].
inline float BandCoverage(float x, float low, float high, float width) {
  const float half = std::max(width, 1e-6f) / 2;
  const float overlap = std::min(x + half, high) - std::max(x - half, low);
  return std::min(std::max(overlap / (2 * half), 0.0f), 1.0f);
}

}  // namespace windhover
