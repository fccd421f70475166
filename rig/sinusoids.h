#pragma once

#include <complex>
#include <functional>
#include <vector>

namespace windhover {

/// amplitude · cos(2π frequency t + phase).
struct Sinusoid {
  double frequency_hz;
  double amplitude;
  double phase_rad;
};

/// A sum of sinusoids: a signal that can be had at any time, in any order. Source: M. Shinozuka
/// & C.-M. Jan, "Digital simulation of random processes and its applications", JSV 1972.
using Sinusoids = std::vector<Sinusoid>;

/// The signal at time `t_s`.
double Value(const Sinusoids& signal, double t_s);

/// Root of the mean square over all time, of lines at distinct frequencies.
double Rms(const Sinusoids& signal);

/// Response of a linear time-invariant system at a frequency: its output divided by its input
/// exp(j 2π f t).
using FrequencyResponse = std::function<std::complex<double>(double frequency_hz)>;

/// What the system makes of `signal`, in steady state.
Sinusoids Filtered(Sinusoids signal, const FrequencyResponse& response);

/// d/dt.
std::complex<double> Differentiation(double frequency_hz);

/// The integral without its constant. @pre frequency_hz > 0
std::complex<double> Integration(double frequency_hz);

/// sin(x) / x, 1 at 0: what a mean over a time in which a phase advances by 2 x leaves of a line.
double Sinc(double x_rad);

/// The mean over [t, t + duration_s], as of an exposure that begins at t.
FrequencyResponse MeanOver(double duration_s);

}  // namespace windhover
