#pragma once

#include <array>

#include "scenarios/scenario.h"
#include "sim/kinematics.h"

namespace windhover {

/// A multirotor with four rotors: 0 front left, 1 front right, 2 rear right, 3 rear left.
struct QuadrotorParameters {
  double mass_kg;
  Eigen::Vector3d inertia_kgm2;  ///< About B's axes through the centre of mass; diagonal.
  double rotor_x_m, rotor_y_m;   ///< Rotors are at (±x, ±y) in B.
  double thrust_Ns2;             ///< k_f: thrust is k_f Ω².
  double largest_thrust_N;       ///< Of one rotor.
  double torque_m;               ///< Reaction torque is this times the thrust.
  double rotor_drag_kg;  ///< c_d: −c_d ΣΩ v, v the air's velocity across the rotor axes.
  double drag_area_m2;   ///< C_d A of the body.
  double speed_up_s, slow_down_s;                    ///< Time constants of a motor.
  Eigen::Vector3d cg_B_m = Eigen::Vector3d::Zero();  ///< Centre of mass in B.

  /// Largest and least speed of a rotor: a motor in flight never stops.
  double LargestSpeed_radps() const;
  double LeastSpeed_radps() const { return 0.15 * LargestSpeed_radps(); }

  /// Thrusts that together give `force_N` along B's z and `torque_Nm` about `about_B_m`.
  Eigen::Vector4d ThrustsFor(double force_N, const Eigen::Vector3d& torque_Nm,
                             const Eigen::Vector3d& about_B_m) const;

  /// Torque of `thrusts_N` about `about_B_m`.
  Eigen::Vector3d TorqueOf(const Eigen::Vector4d& thrusts_N,
                           const Eigen::Vector3d& about_B_m) const;
};

/// The parameters of a type; a mesh of one's own flies as an M200.
QuadrotorParameters QuadrotorParametersOf(AircraftType type);

/// Rigid body with rotors (Martin & Salaün 2010; RotorS; PX4's x500 scaled by mass and size):
///
///     m v̇ = m g + R e_z ΣT − c_d ΣΩ R P Rᵀ(v − w) − ½ ρ C_dA |v − w| (v − w)
///     J ω̇ = Σ (r_i − c) × T_i e_z + Σ s_i c_m T_i e_z − ω × J ω
///     q̇ = ½ q ⊗ (0, ω)        Ω̇_i = (Ω_cmd − Ω_i) / τ        T_i = k_f Ω_i²
///
/// with w the wind, P the projection across B's z, τ that of speeding up or slowing down. Air drag
/// acts at the centre of mass; gyroscopic torques of the rotors, blade flapping, ground effect
/// and downwash are left out.
class Quadrotor {
 public:
  /// p, v of the centre of mass in W, q (w, x, y, z), ω in B, Ω in rad/s, rotor phases in
  /// revolutions.
  using State = Eigen::Matrix<double, 21, 1>;

  explicit Quadrotor(const QuadrotorParameters& parameters) : parameters_(parameters) {
    state_.setZero();
    state_[6] = 1;
  }

  /// One step of the classical Runge-Kutta method; the quaternion is normalised after it.
  void Step(double h_s, const Eigen::Vector4d& command_radps, const Eigen::Vector3d& wind_W_mps);

  /// Time derivative of `state`.
  State Derivative(const State& state, const Eigen::Vector4d& command_radps,
                   const Eigen::Vector3d& wind_W_mps) const;

  /// How the body frame's origin moves. The acceleration is what forces make it now.
  Kinematics Body(const Eigen::Vector3d& wind_W_mps) const;

  /// Puts the body's origin where `body` says, moving and turning as it does, with `thrusts_N`.
  void Reset(const Kinematics& body, const Eigen::Vector4d& thrusts_N);

  const State& state() const { return state_; }
  State& state() { return state_; }
  const QuadrotorParameters& parameters() const { return parameters_; }

  Eigen::Quaterniond q_WB() const { return {state_[6], state_[7], state_[8], state_[9]}; }
  Eigen::Vector3d w_B_radps() const { return state_.segment<3>(10); }
  Eigen::Vector4d rotor_radps() const { return state_.segment<4>(13); }
  Eigen::Vector4d rotor_phase_rev() const { return state_.segment<4>(17); }

 private:
  QuadrotorParameters parameters_;
  State state_;
};

/// Air drag on a quadrotor, N in W, of which B's z is `z_W` and the rotors' speeds add up to
/// `rotor_sum_radps`; `v_air_mps` is its velocity through the air.
Eigen::Vector3d Drag(const QuadrotorParameters& parameters, const Eigen::Vector3d& z_W,
                     double rotor_sum_radps, const Eigen::Vector3d& v_air_mps);

/// Steady flight: what attitude and thrusts keep the acceleration of `state` at its velocity in
/// wind `wind_W_mps`, without torque.
struct Trim {
  Eigen::Vector3d drag_N;  ///< In W.
  Eigen::Vector3d z_W;     ///< B's z.
  Eigen::Vector4d thrusts_N;
};
Trim TrimFor(const QuadrotorParameters& parameters, const Kinematics& state,
             const Eigen::Vector3d& wind_W_mps);

}  // namespace windhover
