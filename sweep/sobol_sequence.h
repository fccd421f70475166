#pragma once

#include <cstdint>
#include <vector>

namespace windhover {

/// Points that fill the unit cube more evenly than random ones: the n-th point of Sobol's sequence.
/// Source: I. M. Sobol, USSR Comput. Math. Math. Phys. 7 (1967); direction numbers of S. Joe and
/// F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections", SIAM J. Sci.
/// Comput. 30 (2008), file new-joe-kuo-6.
class SobolSequence {
 public:
  static constexpr int kMaxDimensions = 16;

  /// @throws std::invalid_argument unless 1 <= dimensions <= kMaxDimensions.
  explicit SobolSequence(int dimensions);

  /// Point n, each coordinate in [0, 1), the middle of the 2^-32 that the sequence fixes.
  std::vector<double> Point(std::uint32_t n) const;

 private:
  std::vector<std::vector<std::uint32_t>> directions_;  ///< [dimension][bit]
};

}  // namespace windhover
