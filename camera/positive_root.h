#pragma once

#include <vector>

namespace windhover {

/// The smallest s > 0 at which the polynomial Σ coefficients[i] sⁱ changes its sign, to rounding;
/// infinity if it never does. Lens models use it to find where they stop being invertible.
double FirstPositiveRoot(const std::vector<double>& coefficients);

}  // namespace windhover
