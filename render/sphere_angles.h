#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace windhover {

/// atan2(y, x), true to 1e-13 rad, of additions, products and divisions alone: loops of it are
/// done several at a time, to the same bits. (0, 0) has no direction.
inline double QuickAtan2(double y, double x) {
  constexpr int kTerms = 18;  // Of atan r = r - r³/3 + r⁵/5 - …, |r| < tan 22.5°.
  constexpr auto kCoefficients = [] {
    std::array<double, kTerms> c{};
    for (int k = 0; k < kTerms; ++k) {
      c[static_cast<std::size_t>(k)] = (k % 2 == 0 ? 1.0 : -1.0) / (2 * k + 1);
    }
    return c;
  }();
  const double ax = std::fabs(x), ay = std::fabs(y);
  const double low = ax < ay ? ax : ay, high = ax < ay ? ay : ax;
  // atan a = 45° + atan((a - 1) / (a + 1)).
  const bool is_steep = low > (std::numbers::sqrt2 - 1) * high;
  const double r = (is_steep ? low - high : low) / (is_steep ? low + high : high);
  const double z = r * r;
  double series = kCoefficients[kTerms - 1];
#pragma GCC unroll 18
  for (int k = kTerms - 2; k >= 0; --k) {
    series = kCoefficients[static_cast<std::size_t>(k)] + z * series;
  }
  double angle = (is_steep ? std::numbers::pi / 4 : 0) + r * series;
  angle = ax < ay ? std::numbers::pi / 2 - angle : angle;
  angle = x < 0 ? std::numbers::pi - angle : angle;
  return y < 0 ? -angle : angle;
}

/// Turns `n` directions into angles: azimuth (about z, from x) in `x`, angle from z in `y`.
void FindSphereAngles(std::size_t n, double* x, double* y, const double* z);

}  // namespace windhover
