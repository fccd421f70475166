#pragma once

#include <Eigen/Core>

#include "scenarios/swarm_config.h"

namespace windhover {

/// One sighting of another aircraft.
struct Sighting {
  Eigen::Vector3d p_WT_m;
  Eigen::Matrix3d covariance_m2;
  int estimator_track;  ///< The estimator's number, which may change hands.
};

/// The covariance of what is seen along `line_W` (unit) at `range_m`: range_sigma_m along it,
/// the angle's sigma times the range across. A range_sigma_m that is none counts 5 % of the range;
/// below 1 % of it, and below 3 cm, nothing is believed.
Eigen::Matrix3d SightingCovariance(const Eigen::Vector3d& line_W, double range_m,
                                   double range_sigma_m, double bearing_sigma_rad);

/// Where another aircraft is and how it moves, in W: a Kalman filter whose velocity is a random
/// walk. Source: Y. Bar-Shalom, X. Li & T. Kirubarajan, "Estimation with Applications to Tracking
/// and Navigation", 2001, §6.2.2 (continuous white noise acceleration).
class TrackFilter {
 public:
  /// At rest at the first sighting, to `speed_sigma_mps` in each direction.
  TrackFilter(const Sighting& first, double speed_sigma_mps);

  /// Moves on by dt_s; velocities change by acceleration_mps2 · √s in a second, one sigma.
  void Predict(double dt_s, double acceleration_mps2);

  /// Squared Mahalanobis distance of `sighting` from the track, by both covariances.
  double SquaredDistance(const Sighting& sighting) const;

  /// −2 log of the sighting's likelihood, up to a constant.
  double Cost(const Sighting& sighting) const;

  void Update(const Sighting& sighting);

  Eigen::Vector3d p_WT_m() const { return state_.head<3>(); }
  Eigen::Vector3d v_WT_mps() const { return state_.tail<3>(); }
  Eigen::Matrix3d PositionCovariance() const { return covariance_.topLeftCorner<3, 3>(); }

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;

  Vector6d state_;  // Position, velocity.
  Matrix6d covariance_ = Matrix6d::Zero();
};

}  // namespace windhover
