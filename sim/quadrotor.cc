#include "sim/quadrotor.h"

#include <cmath>
#include <numbers>

namespace windhover {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kAirDensity_kgpm3 = 1.225;
// Signs of x, of y and of the reaction torque of rotors 0 to 3.
const Vector4d kSignX(1, 1, -1, -1), kSignY(1, -1, -1, 1), kSpin(1, -1, 1, -1);

// Rotor drag is 0.12 1/s of the mass at hover.
double RotorDrag_kg(double mass_kg, double thrust_Ns2) {
  const double hover_radps = std::sqrt(mass_kg * kGravity_mps2 / 4 / thrust_Ns2);
  return 0.12 * mass_kg / (4 * hover_radps);
}

}  // namespace

QuadrotorParameters QuadrotorParametersOf(AircraftType type) {
  if (type == AircraftType::kP600) {
    return {.mass_kg = 3.8,
            .inertia_kgm2 = {0.058, 0.058, 0.108},
            .rotor_x_m = 0.2121,
            .rotor_y_m = 0.2121,
            .thrust_Ns2 = 7.4e-5,
            .largest_thrust_N = 19,
            .torque_m = 0.016,
            .rotor_drag_kg = RotorDrag_kg(3.8, 7.4e-5),
            .drag_area_m2 = 0.035,
            .speed_up_s = 0.03,
            .slow_down_s = 0.05};
  }
  return {.mass_kg = 4.53,
          .inertia_kgm2 = {0.081, 0.081, 0.150},
          .rotor_x_m = 0.2275,
          .rotor_y_m = 0.224,
          .thrust_Ns2 = 1.13e-4,
          .largest_thrust_N = 25,
          .torque_m = 0.016,
          .rotor_drag_kg = RotorDrag_kg(4.53, 1.13e-4),
          .drag_area_m2 = 0.06,
          .speed_up_s = 0.03,
          .slow_down_s = 0.06};
}

double QuadrotorParameters::LargestSpeed_radps() const {
  return std::sqrt(largest_thrust_N / thrust_Ns2);
}

// Columns of the allocation are orthogonal, so that its inverse is its transpose, scaled.
Vector4d QuadrotorParameters::ThrustsFor(double force_N, const Vector3d& torque_Nm,
                                         const Vector3d& about_B_m) const {
  // The same torque about B's origin: the force's own about `about` is added.
  const Vector3d torque_B_Nm = torque_Nm + about_B_m.cross(Vector3d(0, 0, force_N));
  return (Vector4d::Constant(force_N) + torque_B_Nm.x() / rotor_y_m * kSignY -
          torque_B_Nm.y() / rotor_x_m * kSignX + torque_B_Nm.z() / torque_m * kSpin) /
         4;
}

Vector3d QuadrotorParameters::TorqueOf(const Vector4d& thrusts_N, const Vector3d& about_B_m) const {
  const Vector3d torque_B_Nm(rotor_y_m * kSignY.dot(thrusts_N), -rotor_x_m * kSignX.dot(thrusts_N),
                             torque_m * kSpin.dot(thrusts_N));
  return torque_B_Nm - about_B_m.cross(Vector3d(0, 0, thrusts_N.sum()));
}

Vector3d Drag(const QuadrotorParameters& parameters, const Vector3d& z_W, double rotor_sum_radps,
              const Vector3d& v_air_mps) {
  const Vector3d across_mps = v_air_mps - z_W * z_W.dot(v_air_mps);
  const double body = kAirDensity_kgpm3 / 2 * parameters.drag_area_m2 * v_air_mps.norm();
  return -parameters.rotor_drag_kg * rotor_sum_radps * across_mps - body * v_air_mps;
}

Quadrotor::State Quadrotor::Derivative(const State& state, const Vector4d& command_radps,
                                       const Vector3d& wind_W_mps) const {
  const QuadrotorParameters& my = parameters_;
  const Vector3d v = state.segment<3>(3), w = state.segment<3>(10);
  const Vector4d rotors = state.segment<4>(13);
  const Quaterniond q(state[6], state[7], state[8], state[9]);
  const Vector3d z_W = q.normalized() * Vector3d::UnitZ();
  const Vector4d thrusts = my.thrust_Ns2 * rotors.cwiseAbs2();
  const Vector3d force = thrusts.sum() * z_W + Drag(my, z_W, rotors.sum(), v - wind_W_mps);
  const Vector3d momentum = my.inertia_kgm2.cwiseProduct(w);
  const Vector3d torque = my.TorqueOf(thrusts, my.cg_B_m) - w.cross(momentum);
  const Quaterniond dq = q * Quaterniond(0, w.x() / 2, w.y() / 2, w.z() / 2);
  State derivative;
  derivative.segment<3>(0) = v;
  derivative.segment<3>(3) = GravityInWorld() + force / my.mass_kg;
  derivative.segment<4>(6) << dq.w(), dq.x(), dq.y(), dq.z();
  derivative.segment<3>(10) = torque.cwiseQuotient(my.inertia_kgm2);
  for (int i = 0; i < 4; ++i) {
    const double missing = command_radps[i] - rotors[i];
    derivative[13 + i] = missing / (missing > 0 ? my.speed_up_s : my.slow_down_s);
  }
  derivative.segment<4>(17) = rotors / (2 * std::numbers::pi);
  return derivative;
}

void Quadrotor::Step(double h_s, const Vector4d& command_radps, const Vector3d& wind_W_mps) {
  const auto slope = [&](const State& state) -> State {
    return Derivative(state, command_radps, wind_W_mps);
  };
  const State k1 = slope(state_);
  const State k2 = slope(state_ + h_s / 2 * k1);
  const State k3 = slope(state_ + h_s / 2 * k2);
  const State k4 = slope(state_ + h_s * k3);
  state_ += h_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  state_.segment<4>(6).normalize();
}

Kinematics Quadrotor::Body(const Vector3d& wind_W_mps) const {
  // Commands act through the motors' lag: they have no part in the acceleration of now.
  const State derivative = Derivative(state_, rotor_radps(), wind_W_mps);
  const Vector3d w = w_B_radps(), dw = derivative.segment<3>(10), c = parameters_.cg_B_m;
  Kinematics body;
  body.q_WB = q_WB();
  body.w_WB_B_radps = w;
  body.p_WB_m = state_.segment<3>(0) - body.q_WB * c;
  body.v_WB_mps = state_.segment<3>(3) - body.q_WB * w.cross(c);
  body.a_WB_mps2 = derivative.segment<3>(3) - body.q_WB * (dw.cross(c) + w.cross(w.cross(c)));
  return body;
}

void Quadrotor::Reset(const Kinematics& body, const Vector4d& thrusts_N) {
  const Vector3d c = parameters_.cg_B_m;
  state_.segment<3>(0) = body.p_WB_m + body.q_WB * c;
  state_.segment<3>(3) = body.v_WB_mps + body.q_WB * body.w_WB_B_radps.cross(c);
  state_.segment<4>(6) << body.q_WB.w(), body.q_WB.x(), body.q_WB.y(), body.q_WB.z();
  state_.segment<3>(10) = body.w_WB_B_radps;
  state_.segment<4>(13) = (thrusts_N / parameters_.thrust_Ns2).cwiseMax(0).cwiseSqrt();
  state_.segment<4>(17).setZero();
}

Trim TrimFor(const QuadrotorParameters& parameters, const Kinematics& state,
             const Vector3d& wind_W_mps) {
  Trim trim{Vector3d::Zero(), Vector3d::UnitZ(), Vector4d::Zero()};
  // Drag depends on the attitude that carries it; each round leaves about a tenth of the error.
  for (int i = 0; i < 30; ++i) {
    const Vector3d force_N =
        parameters.mass_kg * (state.a_WB_mps2 - GravityInWorld()) - trim.drag_N;
    trim.z_W = force_N.normalized();
    trim.thrusts_N = parameters.ThrustsFor(force_N.norm(), Vector3d::Zero(), parameters.cg_B_m);
    const double sum = (trim.thrusts_N / parameters.thrust_Ns2).cwiseMax(0).cwiseSqrt().sum();
    trim.drag_N = Drag(parameters, trim.z_W, sum, state.v_WB_mps - wind_W_mps);
  }
  return trim;
}

}  // namespace windhover
