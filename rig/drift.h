#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/random/random_stream.h"

namespace windhover {

/// An Ornstein-Uhlenbeck process: Gaussian, of mean 0, with E[x(s) x(t)] = σ² exp(-|s - t| / τ);
/// a random walk on a spring. Any time from 0 to 2^17 s (36 h), in any order.
///
/// Between two moments that are known the middle one is Gaussian with mean
/// (x₁ + x₂) / (2 cosh(h / τ)) and variance σ² tanh(h / τ), where h is half their distance: from
/// the ends of the span moments are halved, each with a draw of its own, down to τ / 128; straight
/// lines join those, which takes 0.3 % from the variance between them. Source: P. Lévy's
/// construction of Brownian motion, with the conditional law of this process.
class OrnsteinUhlenbeck {
 public:
  OrnsteinUhlenbeck(double sigma, double time_constant_s, RandomStream stream);

  /// Beyond the span as at its end.
  double At(double t_s) const;

 private:
  struct Halving {
    double mean_gain, sigma;
  };

  double Middle(std::size_t level, std::uint64_t interval, double low, double high) const;

  RandomStream stream_;
  double first_, last_;
  double early_;  ///< At the end of the first 512 s.
  std::vector<Halving> halvings_;
};

}  // namespace windhover
