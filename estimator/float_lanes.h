#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace windhover {

/// `kWidth` floats that are worked on at once. The compiler makes of them what the processor has;
/// all that is done with them is done in the same order everywhere, without fused operations and
/// without libm: the same bits on every machine.
template <int kWidth>
struct FloatLanes {
  typedef float Type __attribute__((vector_size(kWidth * sizeof(float))));
};

// Always inlined, so that the caller's instruction set holds for them, too. Vectors are passed by
// address: how they are passed by value depends on the instruction set.
#define WINDHOVER_LANES inline __attribute__((always_inline))

/// e^x to 2e-7 of its value, for x held within ±87. Source: S. L. Moshier's Cephes, expf.
template <typename Vector>
WINDHOVER_LANES void Exp(const Vector& x, Vector* result) {
  typedef std::int32_t Ints __attribute__((vector_size(sizeof(Vector))));
  constexpr float kRound = 0x1.8p23f;  // Adding and taking it away rounds to whole numbers.
  const Vector low = Vector{} - 87.0f, high = Vector{} + 87.0f;
  const Vector above = x < low ? low : x;
  const Vector held = above > high ? high : above;
  const Vector n = (held * std::numbers::log2e_v<float> + kRound) - kRound;
  const Vector r = (held - n * 0.693359375f) + n * 2.12194440e-4f;
  Vector p = r * 1.9875691500e-4f + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  p = p * (r * r) + r + 1.0f;
  const Ints exponent = (__builtin_convertvector(n, Ints) + 127) << 23;
  Vector power;
  __builtin_memcpy(&power, &exponent, sizeof power);
  *result = p * power;
}

/// x Φ(x), the Gaussian error linear unit, and its derivative Φ(x) + x φ(x); Φ to 2e-7.
/// Sources: D. Hendrycks & K. Gimpel, arXiv 1606.08415; Φ: Abramowitz & Stegun 7.1.26.
template <typename Vector>
WINDHOVER_LANES void Gelu(const Vector& x, Vector* value, Vector* slope) {
  const Vector z = (x < 0.0f ? -x : x) * (std::numbers::sqrt2_v<float> / 2);
  const Vector t = 1.0f / (z * 0.3275911f + 1.0f);
  Vector e;
  Exp<Vector>(-(z * z), &e);
  Vector p = t * 1.061405429f - 1.453152027f;
  p = p * t + 1.421413741f;
  p = p * t - 0.284496736f;
  p = p * t + 0.254829592f;
  const Vector tail = p * t * e * 0.5f;  // Φ(-|x|)
  const Vector phi = x > 0.0f ? 1.0f - tail : tail;
  *value = x * phi;
  *slope = phi + x * (e * 0.39894228f);
}

/// 1/√x for normal x > 0, to 2e-7 of its value: Newton's method from the halved exponent.
template <typename Vector>
WINDHOVER_LANES void InverseSqrt(const Vector& x, Vector* result) {
  typedef std::int32_t Ints __attribute__((vector_size(sizeof(Vector))));
  Ints bits;
  __builtin_memcpy(&bits, &x, sizeof bits);
  bits = 0x5f375a86 - (bits >> 1);
  Vector y;
  __builtin_memcpy(&y, &bits, sizeof y);
  const Vector half = x * 0.5f;
  for (int i = 0; i < 4; ++i) y = y * (1.5f - half * y * y);
  *result = y;
}

/// tanh x, to 2e-7.
template <typename Vector>
WINDHOVER_LANES void Tanh(const Vector& x, Vector* result) {
  Vector e;
  Exp<Vector>(x * 2.0f, &e);
  *result = 1.0f - 2.0f / (e + 1.0f);
}

// The same for one number in full precision.
inline void Gelu(const double& x, double* value, double* slope) {
  const double phi = std::erfc(-x / std::numbers::sqrt2) / 2;
  *value = x * phi;
  *slope = phi + x * std::exp(-x * x / 2) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}
inline void InverseSqrt(const double& x, double* result) { *result = 1 / std::sqrt(x); }
inline void Tanh(const double& x, double* result) { *result = std::tanh(x); }

#undef WINDHOVER_LANES

}  // namespace windhover
