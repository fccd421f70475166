#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "rig/sinusoids.h"

namespace windhover {

/// Frequencies (first + i) · fundamental_hz, i from 0 on.
struct Harmonics {
  double fundamental_hz;
  std::size_t first;
};

/// Of a signal whose lines are these to rounding, as a Fourier series' are; nothing if they are
/// not, are too few for it to matter (256), or so many that their table would be larger than 64 MiB
/// (2^18, 43 minutes at 200 Hz).
std::optional<Harmonics> HarmonicsOf(const Sinusoids& signal);

/// Up to eight sums of harmonics of one fundamental. They are periodic and band-limited, so a
/// table of one period is all there is to know: any moment is the sum of the 16 nearest entries,
/// weighted by a Kaiser-Bessel window, whose own spectrum was divided out of the lines. Two to
/// four entries per half a period of the highest line; what the window lets through of the
/// table's repeated spectrum is below 1e-13 of the amplitudes. Source: J. A. Fessler and B. P.
/// Sutton, "Nonuniform fast Fourier transforms using min-max interpolation", IEEE TSP 2003, sec.
/// IV.
class PeriodicSums {
 public:
  static constexpr std::size_t kMaxSums = 8;

  PeriodicSums(const Harmonics& harmonics, const std::vector<Sinusoids>& sums);

  /// Writes kMaxSums values, 0 of sums that are not there.
  void At(double t_s, double* values) const;

 private:
  double fundamental_hz_;
  double n_entries_;           ///< Of one period.
  std::vector<double> table_;  ///< Of each entry the eight sums; 8 entries more before and after.
};

}  // namespace windhover
