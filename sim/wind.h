#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Core>

#include "common/random/random_stream.h"
#include "scenarios/flight_config.h"

namespace windhover {

/// Scales and intensities of Dryden's turbulence along and across the mean wind (u, v) and upwards
/// (w): MIL-F-8785C, below 1000 ft, where L_v = L_u and sigma_v = sigma_u. (MIL-HDBK-1797 halves
/// the lateral scales and has other transfer functions.)
struct DrydenScales {
  double L_u_m, L_w_m;
  double sigma_u_mps, sigma_w_mps;
};

/// At `height_m` above the ground, taken as between 10 and 1000 ft, for a wind of `w20_mps` at
/// 20 ft.
DrydenScales DrydenScalesAt(double height_m, double w20_mps);

/// One step of the second-order shaping filter of v and w, in units of its time constant T = L / V:
/// z⁺ = phi z + chol n with n two standard normal numbers, gust = σ (z₁ + √3 z₂), stationary
/// covariance of z: a quarter of unity. Exact for any length of step.
struct GustStep {
  Eigen::Matrix2d phi, chol;
};

/// The step of `r` = dt / T. @pre r > 0.
GustStep GustStepOf(double r);

/// Gusts that one aircraft meets, by filtered white noise.
class DrydenGusts {
 public:
  /// `name` ("uav0") makes them this aircraft's own; `correlation` is the share of the noise's
  /// variance that all aircraft of the seed have in common.
  DrydenGusts(std::uint64_t seed, const std::string& name, double correlation);

  /// Moves on by dt_s while `speed_mps` of air pass by: u, v, w. The variance is right after any
  /// number of steps of any length.
  Eigen::Vector3d Step(double dt_s, double speed_mps, const DrydenScales& scales);

 private:
  double Noise();

  RandomStream own_, common_;
  double own_share_, common_share_;  // Of the standard deviation.
  double u_;                         // In units of sigma, as all states here.
  Eigen::Vector2d v_, w_;
};

/// The air around one aircraft.
class Wind {
 public:
  Wind(const WindConfig& config, std::uint64_t seed, const std::string& name);

  const Eigen::Vector3d& mean_W_mps() const { return mean_W_mps_; }

  /// Velocity of the air in W, dt_s after the last call, where an aircraft flies. Turbulence is
  /// frozen into air that moves past it with the greatest of its airspeed, the mean wind and
  /// 1 m/s.
  Eigen::Vector3d Step(double dt_s, double height_m, const Eigen::Vector3d& v_WB_mps);

 private:
  Eigen::Vector3d mean_W_mps_;
  double w20_mps_;
  Eigen::Matrix3d R_WG_;  // Gust axes: along the mean wind (east in calm air), left of it, up.
  DrydenGusts gusts_;
};

}  // namespace windhover
