#include "budget/bar_angles.h"

#include <array>
#include <cmath>

#include "rig/bar_modes.h"
#include "rig/base_vibration.h"
#include "rig/isolator.h"

namespace windhover {
namespace {

// A synthesised line lies anywhere in its bin, so that one flight's power is not the spectrum's;
// the mean of these flights is within 1 % of it.
constexpr int kFlights = 32;

double SquaredGain(const BarModes& modes, const Mode& mode, double frequency_hz) {
  return std::norm(modes.participation * Response(mode, frequency_hz));
}

// Mean square of the tips' deflection by the broadband part of the vibration along `axis` of B.
double FloorPower_m2(const VibrationConfig& vibration, const BarModes& modes, const Mode& mode,
                     int axis) {
  double power_m2 = 0;
  for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
    const BaseVibration base = MakeBaseVibration(vibration, seed, "uav0");
    for (const Sinusoid& line : base.acceleration_mps2[axis]) {
      power_m2 += line.amplitude * line.amplitude / 2 *
                  SquaredGain(modes, mode, line.frequency_hz) / kFlights;
    }
  }
  return power_m2;
}

// The same by the tones of four rotors about the reference speed, each with phases of its own.
double TonePower_m2(const VibrationConfig& vibration, const BarModes& modes, const Mode& mode,
                    int axis) {
  if (vibration.source != VibrationSource::kRotors) return 0;
  const RotorToneConfig& tones = vibration.rotors;
  const double factor =
      vibration.level * FactorsOf(vibration.preset).tones * vibration.axis_ratio[axis];
  double power_m2 = 0;
  for (const auto& [order, amplitude_mps2] :
       {std::pair{1, tones.a_1p_mps2}, {2, tones.a_2p_mps2}, {4, tones.a_4p_mps2}}) {
    // The mean over the rotors' speeds, on a grid finer than a resonance.
    constexpr int kSpeeds = 64;
    for (int i = 0; i < kSpeeds; ++i) {
      const double speed = 1 + kRotorSpread * (2 * (i + 0.5) / kSpeeds - 1);
      const double frequency_hz = order * tones.reference_hz * speed;
      const double mounted = std::abs(Transmissibility(vibration.isolator, frequency_hz));
      const double amplitude = factor * amplitude_mps2 * speed * speed * mounted;
      power_m2 += 4 * amplitude * amplitude / 2 * SquaredGain(modes, mode, frequency_hz) / kSpeeds;
    }
  }
  return power_m2;
}

}  // namespace

BarAngles BarAnglesByVibration(const Scenario& scenario) {
  const double baseline_m = scenario.rig.calibrated.baseline_m;
  const BarModes modes = ModesOf(scenario.flex, baseline_m);
  const auto angle_rad = [&](const Mode& mode, int axis) {
    const double power_m2 = FloorPower_m2(scenario.vibration, modes, mode, axis) +
                            TonePower_m2(scenario.vibration, modes, mode, axis);
    return 2 * TipSlope_rad(std::sqrt(power_m2), baseline_m / 2);
  };
  return {.yaw_rad = angle_rad(modes.forward, 0), .roll_rad = angle_rad(modes.up, 2)};
}

}  // namespace windhover
