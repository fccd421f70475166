#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "rig/sinusoids.h"
#include "rig/vibration.h"

namespace windhover {

/// The rotors of an aircraft turn at one speed, each up to this share faster or slower, evenly
/// spread: they differ by mixing and where the mass lies.
inline constexpr double kRotorSpread = 0.03;

/// What a preset makes of the normal amplitudes.
struct PresetFactors {
  double tones, floor, angular_rate;
};
PresetFactors FactorsOf(VibrationPreset preset);

/// Stationary motion of the bar's root by vibration, along and about the axes of B: forward, left,
/// up.
struct BaseVibration {
  std::array<Sinusoids, 3> acceleration_mps2;
  std::array<Sinusoids, 3> angular_rate_radps;
};

/// The broadband vibration that `config` describes, behind its isolator; the tones of rotors are
/// DrivenBar's. Every axis has a random stream of its own, so that no two shake alike.
/// @throws ConfigError if a file cannot be used.
BaseVibration MakeBaseVibration(const VibrationConfig& config, std::uint64_t seed,
                                const std::string& name);

}  // namespace windhover
