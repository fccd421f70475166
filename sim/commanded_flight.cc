#include "sim/commanded_flight.h"

#include <algorithm>
#include <cmath>

#include "sim/flatness.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kVelocityResponse_s = 0.4;
constexpr double kAccelerationLag_s = 0.1;
constexpr double kLargestAcceleration_mps2 = 6;
constexpr double kYawResponse_s = 0.2;
constexpr double kLargestYawRate_radps = 2;
constexpr double kLargestStep_s = 0.005;  // RK4 errs by (0.005 / 0.1)⁵ / 120 = 3e-9 of a change.

Vector3d Limited(const Vector3d& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Vector3d(v * (largest / norm)) : v;
}

}  // namespace

CommandedFlight::CommandedFlight(const Vector3d& p_WB_m, double yaw_rad) : yaw_rad_(yaw_rad) {
  motion_.col(0) = p_WB_m;
}

Vector3d CommandedFlight::Jerk(const Motion& motion, const FlightCommand& command) {
  const Vector3d wanted_mps2 =
      Limited((command.v_WB_mps - motion.col(1)) / kVelocityResponse_s, kLargestAcceleration_mps2);
  return (wanted_mps2 - motion.col(2)) / kAccelerationLag_s;
}

CommandedFlight::Motion CommandedFlight::Derivative(const Motion& motion,
                                                    const FlightCommand& command) {
  Motion derivative;
  derivative << motion.col(1), motion.col(2), Jerk(motion, command);
  return derivative;
}

void CommandedFlight::Step(double h_s, const FlightCommand& command) {
  const Motion k1 = Derivative(motion_, command);
  const Motion k2 = Derivative(motion_ + h_s / 2 * k1, command);
  const Motion k3 = Derivative(motion_ + h_s / 2 * k2, command);
  const Motion k4 = Derivative(motion_ + h_s * k3, command);
  motion_ += h_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4);

  // The yaw rate tends to its command exponentially; both have closed forms.
  const double wanted_radps =
      std::clamp(command.yaw_rate_radps, -kLargestYawRate_radps, kLargestYawRate_radps);
  const double decay = std::exp(-h_s / kYawResponse_s);
  const double excess_radps = yaw_rate_radps_ - wanted_radps;
  yaw_rad_ += wanted_radps * h_s + excess_radps * kYawResponse_s * (1 - decay);
  yaw_rate_radps_ = wanted_radps + excess_radps * decay;
}

void CommandedFlight::Advance(double duration_s, const FlightCommand& command) {
  command_ = command;
  const int n = static_cast<int>(std::ceil(duration_s / kLargestStep_s));
  for (int i = 0; i < n; ++i) Step(duration_s / n, command);
}

Kinematics CommandedFlight::State() const {
  Kinematics state;
  state.p_WB_m = motion_.col(0);
  state.v_WB_mps = motion_.col(1);
  state.a_WB_mps2 = motion_.col(2);
  SetAttitude(Jerk(motion_, command_), yaw_rad_, yaw_rate_radps_, &state);
  return state;
}

}  // namespace windhover
