#include "camera/positive_root.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

double Value(const std::vector<double>& coefficients, double s) {
  double value = 0;
  for (std::size_t i = coefficients.size(); i-- > 0;) value = value * s + coefficients[i];
  return value;
}

// Halves [low, high], at whose ends the signs differ, until nothing is left between them.
double Bisected(const std::vector<double>& coefficients, double low, double high) {
  const bool is_negative = Value(coefficients, low) < 0;
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) return high;
    ((Value(coefficients, middle) < 0) == is_negative ? low : high) = middle;
  }
}

// All sign changes for s > 0, ascending: one at most between two neighbouring extrema.
std::vector<double> PositiveRoots(std::vector<double> coefficients) {
  while (!coefficients.empty() && coefficients.back() == 0) coefficients.pop_back();
  if (coefficients.size() < 2) return {};
  std::vector<double> derivative;
  double largest = 0;
  for (std::size_t i = 1; i < coefficients.size(); ++i) {
    derivative.push_back(static_cast<double>(i) * coefficients[i]);
    largest = std::max(largest, std::abs(coefficients[i - 1]));
  }
  std::vector<double> ends = PositiveRoots(derivative);
  // Cauchy's bound: no root is larger.
  ends.push_back(std::max(ends.empty() ? 0.0 : ends.back(),
                          std::min(1 + largest / std::abs(coefficients.back()), 1e100)));
  std::vector<double> roots;
  double low = 0;
  for (const double high : ends) {
    if ((Value(coefficients, low) < 0) != (Value(coefficients, high) < 0)) {
      roots.push_back(Bisected(coefficients, low, high));
    }
    low = high;
  }
  return roots;
}

}  // namespace

double FirstPositiveRoot(const std::vector<double>& coefficients) {
  const std::vector<double> roots = PositiveRoots(coefficients);
  return roots.empty() ? std::numeric_limits<double>::infinity() : roots.front();
}

}  // namespace windhover
