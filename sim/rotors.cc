#include "sim/rotors.h"

#include <algorithm>
#include <cmath>

#include "common/random/random_stream.h"
#include "rig/base_vibration.h"
#include "sim/quadrotor.h"

namespace windhover {
namespace {

// Revolutions per second at hover: T = C_T ρ n² D⁴ with C_T = 0.105 and T = m g / 4. An M200 of
// 4.53 kg turns 17 inch propellers, a P600 of 3.8 kg some of 15.3 inch.
double HoverRate_hz(AircraftType type) {
  constexpr double kThrustCoefficient = 0.105, kAirDensity_kgpm3 = 1.225;
  const double diameter_m = type == AircraftType::kP600 ? 0.388 : 0.432;
  const double thrust_N = QuadrotorParametersOf(type).mass_kg * kGravity_mps2 / 4;
  return std::sqrt(thrust_N / (kThrustCoefficient * kAirDensity_kgpm3)) / (diameter_m * diameter_m);
}

}  // namespace

Rotors::Rotors(AircraftType type, std::uint64_t seed, const std::string& name) {
  RandomStream stream(seed, name + "/rotors");
  for (double& rate_hz : hover_hz_) {
    rate_hz = HoverRate_hz(type) * (1 + stream.Uniform(-kRotorSpread, kRotorSpread));
  }
  turning_.rate_hz = hover_hz_;
}

void Rotors::Advance(double duration_s, const Kinematics& state) {
  const double thrust_ratio = (state.a_WB_mps2 - GravityInWorld()).norm() / kGravity_mps2;
  for (int i = 0; i < 4; ++i) {
    const double before_hz = turning_.rate_hz[i];
    turning_.rate_hz[i] = hover_hz_[i] * std::sqrt(thrust_ratio);
    turning_.phase_rev[i] += duration_s * (before_hz + turning_.rate_hz[i]) / 2;
  }
}

}  // namespace windhover
