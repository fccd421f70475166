#pragma once

#include <functional>
#include <vector>

namespace windhover {

/// Shares of a response's variance that factors account for.
struct SobolIndices {
  double mean = 0, variance = 0;
  std::vector<double> first;  ///< By itself.
  std::vector<double> total;  ///< With everything that it acts together with.
};

/// Indices of f over the unit cube, from n (d + 2) values of it.
/// Source: A. Saltelli et al., Comput. Phys. Commun. 181 (2010), table 2, (b) for the first and
/// (f), M. J. W. Jansen's, for the total.
/// @param n_factors at most 8; @param n_samples a power of two is best.
SobolIndices ComputeSobolIndices(int n_factors, int n_samples,
                                 const std::function<double(const std::vector<double>&)>& f);

}  // namespace windhover
