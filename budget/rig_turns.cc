#include "budget/rig_turns.h"

#include <cmath>
#include <numbers>

#include "rig/base_vibration.h"
#include "rig/isolator.h"

namespace windhover {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

// Mean square of what a line of angular rate turns within the lag.
double SquaredTurn_rad2(double rate_radps, double frequency_hz, double lag_s, double lag_sigma_s) {
  const double omega_radps = kTwoPi * frequency_hz;
  const double amplitude_rad = rate_radps / omega_radps;
  const double spread_rad = omega_radps * lag_sigma_s;
  const double alike = std::cos(omega_radps * lag_s) * std::exp(-spread_rad * spread_rad / 2);
  return amplitude_rad * amplitude_rad * (1 - alike);
}

// About every axis alike: the tones of four rotors about the reference speed, of two orders.
double TurnByTones_rad2(const VibrationConfig& vibration, double lag_s, double lag_sigma_s) {
  if (vibration.source != VibrationSource::kRotors) return 0;
  const double tone_radps = vibration.level * FactorsOf(vibration.preset).angular_rate *
                            vibration.angular_rate_rms_radps / 2;
  constexpr int kSpeeds = 64;
  double sum_rad2 = 0;
  for (const int order : {1, 2}) {
    for (int i = 0; i < kSpeeds; ++i) {
      const double speed = 1 + kRotorSpread * (2 * (i + 0.5) / kSpeeds - 1);
      const double frequency_hz = order * vibration.rotors.reference_hz * speed;
      const double rate_radps =
          tone_radps * speed * speed * std::abs(Transmissibility(vibration.isolator, frequency_hz));
      sum_rad2 += 4 * SquaredTurn_rad2(rate_radps, frequency_hz, lag_s, lag_sigma_s) / kSpeeds;
    }
  }
  return sum_rad2;
}

}  // namespace

std::array<double, 3> RigTurnsWithin(const Scenario& scenario, double lag_s, double lag_sigma_s) {
  // Lines lie anywhere in their bins: the mean of some flights.
  constexpr int kFlights = 32;
  constexpr std::array<std::size_t, 3> kBodyAxes = {1, 2, 0};  // Left, up, forward.
  const double tones_rad2 = TurnByTones_rad2(scenario.vibration, lag_s, lag_sigma_s);
  std::array<double, 3> squares_rad2 = {tones_rad2, tones_rad2, tones_rad2};
  for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
    const BaseVibration base = MakeBaseVibration(scenario.vibration, seed, "uav0");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const Sinusoid& line : base.angular_rate_radps[kBodyAxes[axis]]) {
        squares_rad2[axis] +=
            SquaredTurn_rad2(line.amplitude, line.frequency_hz, lag_s, lag_sigma_s) / kFlights;
      }
    }
  }
  for (double& square : squares_rad2) square = std::sqrt(square);
  return squares_rad2;
}

}  // namespace windhover
