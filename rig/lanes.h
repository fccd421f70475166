#pragma once

#include <cstddef>
#include <cstring>
#include <numbers>

namespace windhover {

inline constexpr std::size_t kLanes = 8;

/// `kWidth` numbers that are worked on at once.
template <std::size_t kWidth>
struct VectorOf {
  typedef double Type __attribute__((vector_size(kWidth * sizeof(double))));
};

/// Eight numbers; the compiler makes of them what the processor has. All that is done with them
/// is done in the same order everywhere, without fused operations: the same bits.
using Lanes = VectorOf<kLanes>::Type;

// Always inlined, so that the caller's instruction set holds for them, too.
#define WINDHOVER_LANES inline __attribute__((always_inline))

template <typename Vector>
WINDHOVER_LANES void Load(const double* from, Vector* vector) {
  std::memcpy(vector, from, sizeof(Vector));
}

template <typename Vector>
WINDHOVER_LANES void Store(const Vector& vector, double* to) {
  std::memcpy(to, &vector, sizeof(Vector));
}

/// The first half and the second, and so on: three additions deep.
WINDHOVER_LANES double Sum(const Lanes& lanes) {
  const auto half = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) +
                    __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  const auto quarter =
      __builtin_shufflevector(half, half, 0, 1) + __builtin_shufflevector(half, half, 2, 3);
  return quarter[0] + quarter[1];
}

/// cos and sin of 2π `turns`, to 1e-13: Taylor series of a quarter of the angle, which is below
/// π/4, whose next terms are 2e-14 and 1e-15; twice doubled. Adding and taking away 1.5 · 2^52
/// rounds to whole turns.
template <typename Vector>
WINDHOVER_LANES void CosSin(const Vector& turns, Vector* cos, Vector* sin) {
  constexpr double kRound = 0x1.8p52;
  const Vector part = turns - ((turns + kRound) - kRound);
  const Vector x = part * (std::numbers::pi / 2), x2 = x * x;
  Vector s = x2 * (1.0 / 6227020800) - 1.0 / 39916800;
  Vector c = x2 * (-1.0 / 87178291200) + 1.0 / 479001600;
  s = s * x2 + 1.0 / 362880;
  c = c * x2 - 1.0 / 3628800;
  s = s * x2 - 1.0 / 5040;
  c = c * x2 + 1.0 / 40320;
  s = s * x2 + 1.0 / 120;
  c = c * x2 - 1.0 / 720;
  s = s * x2 - 1.0 / 6;
  c = c * x2 + 1.0 / 24;
  s = x + x * (s * x2);
  c = c * x2 - 0.5;
  c = c * x2 + 1.0;
  const Vector two_s = s + s, c2 = 1.0 - two_s * s, two_s2 = 2.0 * (two_s * c);
  *sin = two_s2 * c2;
  *cos = 1.0 - 0.5 * two_s2 * two_s2;
}

/// Two vectors that are worked on alike and wait less for each other's results than one after the
/// other would for its own.
template <typename Vector>
struct TwoOf {
  Vector first, second;

  WINDHOVER_LANES friend TwoOf operator+(const TwoOf& a, const TwoOf& b) {
    return {a.first + b.first, a.second + b.second};
  }
  WINDHOVER_LANES friend TwoOf operator-(const TwoOf& a, const TwoOf& b) {
    return {a.first - b.first, a.second - b.second};
  }
  WINDHOVER_LANES friend TwoOf operator*(const TwoOf& a, const TwoOf& b) {
    return {a.first * b.first, a.second * b.second};
  }
  WINDHOVER_LANES friend TwoOf operator+(const TwoOf& a, double b) {
    return {a.first + b, a.second + b};
  }
  WINDHOVER_LANES friend TwoOf operator-(const TwoOf& a, double b) {
    return {a.first - b, a.second - b};
  }
  WINDHOVER_LANES friend TwoOf operator*(const TwoOf& a, double b) {
    return {a.first * b, a.second * b};
  }
  WINDHOVER_LANES friend TwoOf operator*(double a, const TwoOf& b) { return b * a; }
  WINDHOVER_LANES friend TwoOf operator-(double a, const TwoOf& b) {
    return {a - b.first, a - b.second};
  }
};

#undef WINDHOVER_LANES

}  // namespace windhover
