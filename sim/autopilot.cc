#include "sim/autopilot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/flatness.h"

namespace windhover {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;

// Position: poles near 1 to 2 rad/s. Attitude: 7 rad/s about x and y, where a motor's lag of
// 0.03 to 0.06 s leaves 40 degrees of phase; less about z, for rotors turn an aircraft slowly.
constexpr double kPosition_per_s2 = 2, kVelocity_per_s = 2.8, kPositionIntegral_per_s3 = 0.8;
const Vector3d kAttitude_per_s2(49, 49, 9), kRate_per_s(11, 11, 5),
    kAttitudeIntegral_per_s3(60, 60, 4);
constexpr double kLargestPositionError_m = 4, kLargestVelocityError_mps = 10;
constexpr double kLargestDisturbance_mps2 = 6, kLargestDisturbance_radps2 = 40;
constexpr double kLargestJerk_mps3 = 60, kLargestYawRate_radps = 5;
constexpr double kLeastLift_mps2 = 0.4 * kGravity_mps2, kLargestLift_mps2 = 1.8 * kGravity_mps2;
const double kLargestTilt = std::tan(35 * std::numbers::pi / 180);

Vector3d Limited(const Vector3d& v, double largest) {
  const double norm = v.norm();
  return norm > largest ? Vector3d(v * (largest / norm)) : v;
}

Vector3d Vee(const Matrix3d& skew) { return {skew(2, 1), skew(0, 2), skew(1, 0)}; }

}  // namespace

Vector4d MixedThrusts(const QuadrotorParameters& parameters, double least_N, double force_N,
                      const Vector3d& torque_Nm) {
  const double largest_N = parameters.largest_thrust_N;
  const Vector3d tilt_Nm(torque_Nm.x(), torque_Nm.y(), 0), turn_Nm(0, 0, torque_Nm.z());
  Vector4d tilt = parameters.ThrustsFor(0, tilt_Nm, Vector3d::Zero());
  const Vector4d turn = parameters.ThrustsFor(0, turn_Nm, Vector3d::Zero());
  const double span = tilt.maxCoeff() - tilt.minCoeff();
  if (span > largest_N - least_N) tilt *= (largest_N - least_N) / span;
  const double lift =
      std::min(std::max(force_N / 4, least_N - tilt.minCoeff()), largest_N - tilt.maxCoeff());
  const Vector4d thrusts = Vector4d::Constant(lift) + tilt;
  double share = 1;
  for (int i = 0; i < 4; ++i) {
    const double room = (turn[i] > 0 ? largest_N : least_N) - thrusts[i];
    if (turn[i] != 0) share = std::clamp(room / turn[i], 0.0, share);
  }
  return (thrusts + share * turn).cwiseMax(least_N).cwiseMin(largest_N);
}

Autopilot::Autopilot(const QuadrotorParameters& parameters) : parameters_(parameters) {}

void Autopilot::StartFrom(const Trim& trim) {
  disturbance_W_mps2_ = -trim.drag_N / parameters_.mass_kg;
  disturbance_B_radps2_ = parameters_.TorqueOf(trim.thrusts_N, Vector3d::Zero())
                              .cwiseQuotient(parameters_.inertia_kgm2);
}

Vector3d Autopilot::SpecificThrust(const Kinematics& body, const FlightReference& reference,
                                   double dt_s) {
  const Vector3d behind_m = reference.holds_position
                                ? Limited(reference.p_WB_m - body.p_WB_m, kLargestPositionError_m)
                                : Vector3d(Vector3d::Zero());
  const Vector3d slow_mps = Limited(reference.v_WB_mps - body.v_WB_mps, kLargestVelocityError_mps);
  const Vector3d wanted = reference.a_WB_mps2 + kPosition_per_s2 * behind_m +
                          kVelocity_per_s * slow_mps + disturbance_W_mps2_ - GravityInWorld();
  Vector3d possible = wanted;
  possible.z() = std::clamp(wanted.z(), kLeastLift_mps2, kLargestLift_mps2);
  possible.head<2>() *=
      std::min(1.0, kLargestTilt * possible.z() / std::max(wanted.head<2>().norm(), 1e-9));
  // The integral rests while a limit holds: it would only wind up.
  if ((possible - wanted).norm() < 1e-9) {
    const Vector3d error = reference.holds_position ? Vector3d(kPositionIntegral_per_s3 * behind_m)
                                                    : Vector3d(kPosition_per_s2 * slow_mps);
    disturbance_W_mps2_ = Limited(disturbance_W_mps2_ + dt_s * error, kLargestDisturbance_mps2);
  }
  return possible;
}

Vector3d Autopilot::Torque(const Kinematics& body, const Kinematics& wanted, double dt_s) {
  const Matrix3d R = body.q_WB.toRotationMatrix(), R_wanted = wanted.q_WB.toRotationMatrix();
  const Matrix3d across = R.transpose() * R_wanted;  // From the wanted body axes to the body's.
  const Vector3d error = Vee(across.transpose() - across) / 2;
  const Vector3d rate_error = body.w_WB_B_radps - across * wanted.w_WB_B_radps;
  disturbance_B_radps2_ -= dt_s * kAttitudeIntegral_per_s3.cwiseProduct(error);
  disturbance_B_radps2_ = Limited(disturbance_B_radps2_, kLargestDisturbance_radps2);
  const Vector3d turn = disturbance_B_radps2_ - kAttitude_per_s2.cwiseProduct(error) -
                        kRate_per_s.cwiseProduct(rate_error);
  const Vector3d& inertia = parameters_.inertia_kgm2;
  return inertia.cwiseProduct(turn) +
         body.w_WB_B_radps.cross(inertia.cwiseProduct(body.w_WB_B_radps));
}

Vector4d Autopilot::Command(const Kinematics& body, const FlightReference& reference, double dt_s) {
  const Vector3d thrust_mps2 = SpecificThrust(body, reference, dt_s);
  Kinematics wanted;
  wanted.a_WB_mps2 = thrust_mps2 + GravityInWorld();
  SetAttitude(Limited(reference.jerk_W_mps3, kLargestJerk_mps3), reference.yaw_rad,
              std::clamp(reference.yaw_rate_radps, -kLargestYawRate_radps, kLargestYawRate_radps),
              &wanted);
  const Vector3d torque_Nm = Torque(body, wanted, dt_s);
  const double force_N = parameters_.mass_kg * thrust_mps2.dot(body.q_WB * Vector3d::UnitZ());
  const double least_N = parameters_.thrust_Ns2 * std::pow(parameters_.LeastSpeed_radps(), 2);
  const Vector4d thrusts_N = MixedThrusts(parameters_, least_N, force_N, torque_Nm);
  return (thrusts_N / parameters_.thrust_Ns2).cwiseSqrt();
}

}  // namespace windhover
