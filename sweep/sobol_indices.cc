#include "sweep/sobol_indices.h"

#include <cmath>

#include "sweep/sobol_sequence.h"

namespace windhover {

SobolIndices ComputeSobolIndices(int n_factors, int n_samples,
                                 const std::function<double(const std::vector<double>&)>& f) {
  const auto d = static_cast<std::size_t>(n_factors);
  const SobolSequence sequence(2 * n_factors);
  std::vector<double> of_a, of_b;
  std::vector<std::vector<double>> of_mixed(d);
  for (int i = 0; i < n_samples; ++i) {
    const std::vector<double> both = sequence.Point(static_cast<std::uint32_t>(i));
    const auto middle = both.begin() + n_factors;
    const std::vector<double> a(both.begin(), middle), b(middle, both.end());
    of_a.push_back(f(a));
    of_b.push_back(f(b));
    for (std::size_t k = 0; k < d; ++k) {
      std::vector<double> mixed = a;
      mixed[k] = b[k];
      of_mixed[k].push_back(f(mixed));
    }
  }
  SobolIndices indices;
  const double n = n_samples;
  for (std::size_t i = 0; i < of_a.size(); ++i) indices.mean += (of_a[i] + of_b[i]) / (2 * n);
  for (std::size_t i = 0; i < of_a.size(); ++i) {
    indices.variance +=
        (std::pow(of_a[i] - indices.mean, 2) + std::pow(of_b[i] - indices.mean, 2)) / (2 * n);
  }
  for (std::size_t k = 0; k < d; ++k) {
    double first = 0, total = 0;
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      // About the mean: the same to leading order, with less scatter.
      first += (of_b[i] - indices.mean) * (of_mixed[k][i] - of_a[i]) / n;
      total += std::pow(of_a[i] - of_mixed[k][i], 2) / (2 * n);
    }
    indices.first.push_back(indices.variance > 0 ? first / indices.variance : 0);
    indices.total.push_back(indices.variance > 0 ? total / indices.variance : 0);
  }
  return indices;
}

}  // namespace windhover
