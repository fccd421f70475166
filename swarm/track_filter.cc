#include "swarm/track_filter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace windhover {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d SightingCovariance(const Vector3d& line_W, double range_m, double range_sigma_m,
                            double bearing_sigma_rad) {
  constexpr double kLeast_m = 0.03, kLeastShare = 0.01, kUnknownShare = 0.05;
  const bool is_known = std::isfinite(range_sigma_m) && range_sigma_m > 0;
  const double along_m = std::max(
      {is_known ? range_sigma_m : kUnknownShare * range_m, kLeastShare * range_m, kLeast_m});
  const double across_m = std::max(bearing_sigma_rad * range_m, kLeast_m);
  return across_m * across_m * Matrix3d::Identity() +
         (along_m * along_m - across_m * across_m) * line_W * line_W.transpose();
}

TrackFilter::TrackFilter(const Sighting& first, double speed_sigma_mps) {
  state_ << first.p_WT_m, Vector3d::Zero();
  covariance_.topLeftCorner<3, 3>() = first.covariance_m2;
  covariance_.bottomRightCorner<3, 3>() = speed_sigma_mps * speed_sigma_mps * Matrix3d::Identity();
}

void TrackFilter::Predict(double dt_s, double acceleration_mps2) {
  if (dt_s <= 0) return;
  state_.head<3>() += dt_s * state_.tail<3>();
  Matrix6d transition = Matrix6d::Identity();
  transition.topRightCorner<3, 3>() = dt_s * Matrix3d::Identity();
  const double density = acceleration_mps2 * acceleration_mps2;  // m²/s³
  Matrix6d noise = Matrix6d::Zero();
  noise.topLeftCorner<3, 3>().diagonal().setConstant(density * dt_s * dt_s * dt_s / 3);
  noise.topRightCorner<3, 3>().diagonal().setConstant(density * dt_s * dt_s / 2);
  noise.bottomLeftCorner<3, 3>() = noise.topRightCorner<3, 3>();
  noise.bottomRightCorner<3, 3>().diagonal().setConstant(density * dt_s);
  covariance_ = (transition * covariance_ * transition.transpose() + noise).eval();
}

double TrackFilter::SquaredDistance(const Sighting& sighting) const {
  const Matrix3d innovation_m2 = PositionCovariance() + sighting.covariance_m2;
  const Vector3d residual_m = sighting.p_WT_m - p_WT_m();
  return residual_m.dot(innovation_m2.llt().solve(residual_m));
}

double TrackFilter::Cost(const Sighting& sighting) const {
  const Matrix3d innovation_m2 = PositionCovariance() + sighting.covariance_m2;
  return SquaredDistance(sighting) + std::log(innovation_m2.determinant());
}

void TrackFilter::Update(const Sighting& sighting) {
  const Matrix3d innovation_m2 = PositionCovariance() + sighting.covariance_m2;
  const Eigen::Matrix<double, 6, 3> cross = covariance_.leftCols<3>();
  const Eigen::Matrix<double, 6, 3> gain = innovation_m2.llt().solve(cross.transpose()).transpose();
  state_ += gain * (sighting.p_WT_m - p_WT_m());
  // Joseph's form stays symmetric and positive whatever the rounding.
  Matrix6d kept = Matrix6d::Identity();
  kept.leftCols<3>() -= gain;
  covariance_ =
      (kept * covariance_ * kept.transpose() + gain * sighting.covariance_m2 * gain.transpose())
          .eval();
}

}  // namespace windhover
