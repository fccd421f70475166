#pragma once

#include <complex>

namespace windhover {

/// A damped oscillator, ẍ + 2 ζ ω₁ ẋ + ω₁² x = u(t).
struct Mode {
  double frequency_radps;  ///< ω₁ > 0.
  double damping;          ///< 0 <= ζ <= 1.
};

struct ModeState {
  double x = 0, v = 0;  ///< v is dx/dt.
};

/// Steady-state x per input u at a frequency: 1 / (ω₁² - ω² + 2 i ζ ω₁ ω).
std::complex<double> Response(const Mode& mode, double frequency_hz);

/// What becomes of `state` in `dt_s` without input: exact for any dt_s. Back in time (dt_s < 0),
/// where ringing grows, at most by a factor of e.
ModeState Rung(const Mode& mode, const ModeState& state, double dt_s);

/// Mean of x over [-duration_s / 2, duration_s / 2] about `dt_s`. Exact, from
/// x = -(v' + 2 ζ ω₁ x') / ω₁². @pre duration_s > 0
double MeanRung(const Mode& mode, const ModeState& state, double dt_s, double duration_s);

/// The particular solution under the input u + u_rate t, at t = 0: as the input changes slowly,
/// x = (u - 2 ζ u_rate / ω₁) / ω₁² and v = u_rate / ω₁².
ModeState UnderRamp(const Mode& mode, double u, double u_rate_per_s);

/// One step under an input that goes in a straight line from `u0` to `u1` (that is held, if they
/// are alike): exact for any step, unlike Euler's and Runge and Kutta's.
ModeState Stepped(const Mode& mode, const ModeState& state, double u0, double u1, double dt_s);

inline ModeState operator+(const ModeState& a, const ModeState& b) {
  return {a.x + b.x, a.v + b.v};
}
inline ModeState operator-(const ModeState& a, const ModeState& b) {
  return {a.x - b.x, a.v - b.v};
}

}  // namespace windhover
