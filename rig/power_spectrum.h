#pragma once

#include <string>
#include <vector>

#include "common/random/random_stream.h"
#include "rig/sinusoids.h"

namespace windhover {

/// Standard gravity, for spectra and limits that are written in g.
inline constexpr double kStandardGravity_mps2 = 9.80665;

/// A one-sided power spectral density of acceleration, straight between breakpoints on
/// double-logarithmic paper and zero outside them.
class PowerSpectrum {
 public:
  struct Breakpoint {
    double frequency_hz;
    double g2_per_hz;
  };

  /// @pre at least two breakpoints, frequencies rising, all numbers > 0.
  explicit PowerSpectrum(std::vector<Breakpoint> breakpoints);

  /// The floor of a small multirotor in flight, 10 Hz to 500 Hz, 0.777 g rms. An assumption
  /// within ArduPilot's limits for acceptable vibration ("Measuring Vibration": below 30 m/s²).
  static PowerSpectrum SmallMultirotorFloor();

  /// MIL-STD-810H, method 514.8, category 24: the test of minimum integrity, 7.7 g rms. Ten times
  /// what flight does: an upper limit.
  static PowerSpectrum MilStd810hCategory24();

  /// Reads lines of `f_hz,g2_per_hz`.
  /// @throws ConfigError listing every bad line as file:line: what.
  static PowerSpectrum FromFile(const std::string& file);

  /// Exact mean square between two frequencies, g².
  double Power_g2(double from_hz, double to_hz) const;

  /// A signal with this spectrum above `from_hz`, in m/s²: one sinusoid in each of `n_bins`
  /// logarithmic bins, with exactly the bin's power, at a random frequency within it (so that
  /// the signal has no period) and a random phase. Source: M. Shinozuka & G. Deodatis,
  /// "Simulation of stochastic processes by spectral representation", AMR 1991.
  Sinusoids Synthesize(double from_hz, int n_bins, RandomStream stream) const;

 private:
  std::vector<Breakpoint> breakpoints_;
};

}  // namespace windhover
