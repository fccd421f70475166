#include "estimator/vertical_alignment.h"

#include <algorithm>
#include <cmath>

namespace windhover {

double VerticalAlignment::Observe(Utime utime, double vertical_px, double x, double noise_px,
                                  double gate_sigma) {
  const double dt_s = began_ ? std::max<double>(0, static_cast<double>(utime - utime_) * 1e-6) : 0;
  began_ = true;
  utime_ = std::max(utime_, utime);
  P_(0, 0) += kOffsetWalk_px * kOffsetWalk_px * dt_s;
  P_(1, 1) += kRollWalk_rad * kRollWalk_rad * dt_s;
  const Eigen::Vector2d by_state(1, focal_px_ * x);
  const Eigen::Vector2d Ph = P_ * by_state;
  const double innovation_px = vertical_px - by_state.dot(state_);
  const double variance = by_state.dot(Ph) + noise_px * noise_px;
  const double sigmas = std::abs(innovation_px) / std::sqrt(variance);
  const double doubted = variance * std::max(1.0, std::pow(sigmas / gate_sigma, 2));
  state_ += Ph * (innovation_px / doubted);
  P_ -= Ph * Ph.transpose() / doubted;
  return sigmas;
}

double VerticalAlignment::pitch_sigma_rad() const { return std::sqrt(P_(0, 0)) / focal_px_; }

double VerticalAlignment::roll_sigma_rad() const { return std::sqrt(P_(1, 1)); }

}  // namespace windhover
