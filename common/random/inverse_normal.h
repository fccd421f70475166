#pragma once

namespace windhover {

/// Inverse of the standard normal distribution function at 0 < p < 1, relative error below 1.15e-9.
/// Source: P. J. Acklam, "An algorithm for computing the inverse normal cumulative distribution
/// function", 2003.
double InverseNormal(double p);

}  // namespace windhover
