#include "sim/rigid_flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "sim/flatness.h"
#include "sim/lockstep.h"

namespace windhover {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr Utime kPeriod_us = 2000;
constexpr double kPeriod_s = 0.002;

double YawOf(const Kinematics& state) {
  const Vector3d forward = state.q_WB * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

// What follows from two states a period apart: a path itself does not tell its jerk.
FlightReference ReferenceFrom(const Kinematics& now, const Kinematics& next) {
  FlightReference reference;
  reference.p_WB_m = now.p_WB_m;
  reference.v_WB_mps = now.v_WB_mps;
  reference.a_WB_mps2 = now.a_WB_mps2;
  reference.jerk_W_mps3 = (next.a_WB_mps2 - now.a_WB_mps2) / kPeriod_s;
  reference.yaw_rad = YawOf(now);
  reference.yaw_rate_radps =
      std::remainder(YawOf(next) - reference.yaw_rad, 2 * std::numbers::pi) / kPeriod_s;
  return reference;
}

QuadrotorParameters ParametersOf(const Aircraft& aircraft) {
  QuadrotorParameters parameters = QuadrotorParametersOf(aircraft.type);
  parameters.cg_B_m = Vector3d(aircraft.cg_offset_m.data());
  return parameters;
}

std::array<double, 4> ArrayOf(const Vector4d& v) { return {v[0], v[1], v[2], v[3]}; }

}  // namespace

RigidFlight::RigidFlight(const Aircraft& aircraft, const WindConfig& wind, std::uint64_t seed,
                         const Path* path)
    : name_(fmt::format("uav{}", aircraft.self.id)),
      path_(path),
      shaped_(Vector3d(aircraft.position_m.data()), RadFromDeg(aircraft.yaw_deg)),
      quadrotor_(ParametersOf(aircraft)),
      autopilot_(quadrotor_.parameters()),
      wind_(wind, seed, name_),
      wind_W_mps_(wind_.mean_W_mps()) {
  Start();
}

void RigidFlight::Start() {
  Kinematics start = path_ != nullptr ? path_->At(0) : shaped_.State();
  const Kinematics next = path_ != nullptr ? path_->At(kPeriod_s) : start;
  const FlightReference reference = ReferenceFrom(start, next);
  const Trim trim = TrimFor(quadrotor_.parameters(), start, wind_W_mps_);
  // The attitude of this thrust, not of the path's acceleration alone.
  Kinematics tilted = start;
  tilted.a_WB_mps2 -= trim.drag_N / quadrotor_.parameters().mass_kg;
  SetAttitude(reference.jerk_W_mps3, reference.yaw_rad, reference.yaw_rate_radps, &tilted);
  start.q_WB = tilted.q_WB;
  start.w_WB_B_radps = tilted.w_WB_B_radps;
  quadrotor_.Reset(start, trim.thrusts_N);
  autopilot_.StartFrom(trim);
}

FlightReference RigidFlight::Reference(const FlightCommand& command) {
  if (path_ != nullptr) {
    const double t_s = SecondsFromUtime(utime_);
    return ReferenceFrom(path_->At(t_s), path_->At(t_s + kPeriod_s));
  }
  const Kinematics now = shaped_.State();
  shaped_.Advance(kPeriod_s, command);
  FlightReference reference = ReferenceFrom(now, shaped_.State());
  reference.holds_position = false;
  return reference;
}

void RigidFlight::Control(const FlightCommand& command) {
  const Kinematics body = State();
  const FlightReference reference = Reference(command);
  // Limits of the controller may swallow what is no number.
  const double sum = reference.p_WB_m.sum() + reference.v_WB_mps.sum() + reference.a_WB_mps2.sum() +
                     reference.jerk_W_mps3.sum() + reference.yaw_rad;
  if (!std::isfinite(sum)) FailNotFinite("reference");
  wind_W_mps_ = wind_.Step(kPeriod_s, body.p_WB_m.z(), body.v_WB_mps);
  command_radps_ = autopilot_.Command(body, reference, kPeriod_s);
}

void RigidFlight::FailNotFinite(const char* what) const {
  throw RunInvalid("sim", fmt::format("the {} of {} is not finite at {:.3f} s", what, name_,
                                      SecondsFromUtime(utime_)));
}

void RigidFlight::AdvanceTo(Utime utime, const FlightCommand& command) {
  while (utime_ < utime) {
    if (utime_ % kPeriod_us == 0) Control(command);
    const Utime next = std::min(utime, (utime_ / kPeriod_us + 1) * kPeriod_us);
    quadrotor_.Step(SecondsFromUtime(next - utime_), command_radps_, wind_W_mps_);
    utime_ = next;
    if (!quadrotor_.state().allFinite()) FailNotFinite("state");
  }
}

RotorsTurning RigidFlight::Turning() const {
  return {ArrayOf(quadrotor_.rotor_phase_rev()),
          ArrayOf(quadrotor_.rotor_radps() / (2 * std::numbers::pi))};
}

}  // namespace windhover
