#pragma once

#include <vector>

#include "rig/sinusoids.h"

namespace windhover {

/// Several sums of sinusoids, evaluated together: sums with the same frequencies share their sines
/// and cosines. Value() of each to 1e-14 of its amplitudes, ten times as fast.
class SinusoidSums {
 public:
  explicit SinusoidSums(const std::vector<Sinusoids>& sums);

  /// Writes the value of each sum at `t_s`. The same bits on every processor: all add in the same
  /// order, without fused operations.
  void At(double t_s, double* values) const;

  /// The same on processors with and without AVX-512 and AVX2; At chooses.
  void AtWithAvx512(double t_s, double* values) const;
  void AtWithAvx2(double t_s, double* values) const;
  void AtWithSse2(double t_s, double* values) const;

  /// Lines that are evaluated together: their frequencies, and which sums they make. Lines come in
  /// blocks of eight; of each block first all sums' cosine and sine amplitudes.
  struct Group {
    std::vector<double> frequencies_hz;
    std::vector<std::size_t> sums;
    std::vector<double> amplitudes;
  };

 private:
  std::size_t n_sums_;
  std::vector<Group> groups_;
};

}  // namespace windhover
