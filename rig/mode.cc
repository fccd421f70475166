#include "rig/mode.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace windhover {

std::complex<double> Response(const Mode& mode, double frequency_hz) {
  const double w1 = mode.frequency_radps, w = 2 * std::numbers::pi * frequency_hz;
  return 1.0 / std::complex<double>(w1 * w1 - w * w, 2 * mode.damping * w1 * w);
}

ModeState Rung(const Mode& mode, const ModeState& state, double dt_s) {
  const double w1 = mode.frequency_radps, decay = mode.damping * w1;
  const double w_damped = w1 * std::sqrt(std::max(0.0, 1 - mode.damping * mode.damping));
  const double shrink = std::exp(std::min(1.0, -decay * dt_s));
  const double c = std::cos(w_damped * dt_s);
  // sin(ω t) / ω, and its limit at critical damping.
  const double s = w_damped > 1e-9 * w1 ? std::sin(w_damped * dt_s) / w_damped : dt_s;
  return {shrink * (c * state.x + s * (state.v + decay * state.x)),
          shrink * (c * state.v - s * (w1 * w1 * state.x + decay * state.v))};
}

double MeanRung(const Mode& mode, const ModeState& state, double dt_s, double duration_s) {
  const ModeState begin = Rung(mode, state, dt_s - duration_s / 2);
  const ModeState end = Rung(mode, state, dt_s + duration_s / 2);
  const double w1 = mode.frequency_radps;
  return -(end.v - begin.v + 2 * mode.damping * w1 * (end.x - begin.x)) / (w1 * w1 * duration_s);
}

ModeState UnderRamp(const Mode& mode, double u, double u_rate_per_s) {
  const double w1 = mode.frequency_radps;
  return {(u - 2 * mode.damping * u_rate_per_s / w1) / (w1 * w1), u_rate_per_s / (w1 * w1)};
}

ModeState Stepped(const Mode& mode, const ModeState& state, double u0, double u1, double dt_s) {
  if (dt_s == 0) return state;
  const double u_rate = (u1 - u0) / dt_s;
  return UnderRamp(mode, u1, u_rate) + Rung(mode, state - UnderRamp(mode, u0, u_rate), dt_s);
}

}  // namespace windhover
