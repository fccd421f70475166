#include "rig/sinusoids.h"

#include <cmath>
#include <numbers>

namespace windhover {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

}  // namespace

double Value(const Sinusoids& signal, double t_s) {
  double sum = 0;
  for (const Sinusoid& line : signal) {
    sum += line.amplitude * std::cos(kTwoPi * line.frequency_hz * t_s + line.phase_rad);
  }
  return sum;
}

double Rms(const Sinusoids& signal) {
  double sum = 0;
  for (const Sinusoid& line : signal) sum += line.amplitude * line.amplitude / 2;
  return std::sqrt(sum);
}

Sinusoids Filtered(Sinusoids signal, const FrequencyResponse& response) {
  for (Sinusoid& line : signal) {
    const std::complex<double> gain = response(line.frequency_hz);
    line.amplitude *= std::abs(gain);
    line.phase_rad += std::arg(gain);
  }
  return signal;
}

std::complex<double> Differentiation(double frequency_hz) { return {0, kTwoPi * frequency_hz}; }

std::complex<double> Integration(double frequency_hz) { return {0, -1 / (kTwoPi * frequency_hz)}; }

double Sinc(double x_rad) { return x_rad == 0 ? 1 : std::sin(x_rad) / x_rad; }

FrequencyResponse MeanOver(double duration_s) {
  return [duration_s](double frequency_hz) {
    const double half_turn = std::numbers::pi * frequency_hz * duration_s;
    return std::polar(1.0, half_turn) * Sinc(half_turn);
  };
}

}  // namespace windhover
