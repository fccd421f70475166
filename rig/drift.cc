#include "rig/drift.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kSpan_s = 131072;

// Levels whose early halves hold the first 512 s, which is all of most flights.
constexpr std::size_t kEarlyLevels = 8;
constexpr double kEarlyShare = 1.0 / (1 << kEarlyLevels);

}  // namespace

OrnsteinUhlenbeck::OrnsteinUhlenbeck(double sigma, double time_constant_s, RandomStream stream)
    : stream_(stream) {
  first_ = sigma * stream.Normal();
  const double rho = std::exp(-kSpan_s / time_constant_s);
  last_ = rho * first_ + sigma * std::sqrt(1 - rho * rho) * stream.Normal();
  for (double half_s = kSpan_s / 2; half_s > time_constant_s / 256; half_s /= 2) {
    halvings_.push_back({0.5 / std::cosh(half_s / time_constant_s),
                         sigma * std::sqrt(std::tanh(half_s / time_constant_s))});
  }
  early_ = last_;
  for (std::size_t level = 0; level < std::min(kEarlyLevels, halvings_.size()); ++level) {
    early_ = Middle(level, 0, first_, early_);
  }
}

double OrnsteinUhlenbeck::Middle(std::size_t level, std::uint64_t interval, double low,
                                 double high) const {
  RandomStream stream = stream_;
  stream.Seek((std::uint64_t{2} << level) + interval);
  return halvings_[level].mean_gain * (low + high) + halvings_[level].sigma * stream.Normal();
}

double OrnsteinUhlenbeck::At(double t_s) const {
  // Where in the interval between `low` and `high`, 0 to 1; which of its level's it is.
  double place = std::clamp(t_s / kSpan_s, 0.0, 1.0);
  double low = first_, high = last_;
  std::uint64_t interval = 0;
  std::size_t level = 0;
  if (place < kEarlyShare && halvings_.size() >= kEarlyLevels) {
    level = kEarlyLevels;
    place /= kEarlyShare;  // Exact, as is each doubling below.
    high = early_;
  }
  for (; level < halvings_.size(); ++level) {
    const double middle = Middle(level, interval, low, high);
    const bool is_late = place >= 0.5;
    place = 2 * place - (is_late ? 1 : 0);
    interval = 2 * interval + (is_late ? 1 : 0);
    (is_late ? low : high) = middle;
  }
  return low + place * (high - low);
}

}  // namespace windhover
