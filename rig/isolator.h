#pragma once

#include <complex>

#include "rig/vibration.h"

namespace windhover {

/// Motion of what stands on soft mounts per motion of what they stand on, at a frequency:
/// (1 + 2 i ζ r) / (1 - r² + 2 i ζ r), r = f / f_n; 1 without mounts. Its size is 1 at r = √2
/// whatever the damping, and falls as 2 ζ / r far above. Source: S. S. Rao, "Mechanical
/// Vibrations", base excitation.
inline std::complex<double> Transmissibility(const IsolatorConfig& isolator, double frequency_hz) {
  if (!isolator.enabled) return 1;
  const double r = frequency_hz / isolator.frequency_hz;
  const std::complex<double> damper(0, 2 * isolator.damping * r);
  return (1.0 + damper) / (1 - r * r + damper);
}

}  // namespace windhover
