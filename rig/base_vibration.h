#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "rig/sinusoids.h"
#include "rig/vibration.h"

namespace windhover {

/// Motion of the bar's root by vibration, along and about the axes of B: forward, left, up.
struct BaseVibration {
  std::array<Sinusoids, 3> acceleration_mps2;
  std::array<Sinusoids, 3> angular_rate_radps;
  /// Not 0: every sinusoid's frequency is a multiple of this, the same in all six.
  double line_spacing_hz = 0;
};

/// The vibration that `config` describes. Every axis has a random stream of its own, so that no
/// two shake alike.
/// @throws ConfigError if a file cannot be used.
BaseVibration MakeBaseVibration(const VibrationConfig& config, std::uint64_t seed,
                                const std::string& name);

}  // namespace windhover
