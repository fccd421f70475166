#include "sim/wind.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMetresPerFoot = 0.3048, kMpsPerKnot = 0.514444;

double W20_mps(Turbulence turbulence) {
  switch (turbulence) {
    case Turbulence::kNone:
      return 0;
    case Turbulence::kLight:
      return 15 * kMpsPerKnot;
    case Turbulence::kModerate:
      return 30 * kMpsPerKnot;
    case Turbulence::kSevere:
      return 45 * kMpsPerKnot;
  }
  return 0;
}

// 1 - exp(-x) (1 + x + x²/2), without cancellation where x is small.
double ThirdOrderRemainder(double x) {
  if (x > 1) return 1 - std::exp(-x) * (1 + x + x * x / 2);
  double sum = 0, term = x * x * x / 6;
  for (int n = 4; n < 24; ++n) {
    sum += term;
    term *= x / n;
  }
  return std::exp(-x) * sum;
}

Eigen::Matrix3d GustAxes(const Vector3d& mean_W_mps) {
  const bool is_level = mean_W_mps.head<2>().norm() > 0;
  const Vector3d along =
      is_level ? Vector3d(mean_W_mps.x(), mean_W_mps.y(), 0).normalized() : Vector3d::UnitX();
  Eigen::Matrix3d axes;
  axes << along, Vector3d::UnitZ().cross(along), Vector3d::UnitZ();
  return axes;
}

}  // namespace

DrydenScales DrydenScalesAt(double height_m, double w20_mps) {
  const double h_ft = std::clamp(height_m / kMetresPerFoot, 10.0, 1000.0);
  const double base = 0.177 + 0.000823 * h_ft;
  const double sigma_w_mps = 0.1 * w20_mps;
  return {.L_u_m = kMetresPerFoot * h_ft / std::pow(base, 1.2),
          .L_w_m = kMetresPerFoot * h_ft,
          .sigma_u_mps = sigma_w_mps / std::pow(base, 0.4),
          .sigma_w_mps = sigma_w_mps};
}

GustStep GustStepOf(double r) {
  GustStep step;
  step.phi << 1 + r, r, -r, 1 - r;
  step.phi *= std::exp(-r);
  // Covariance of what the step adds: (1 - phi phi^T) / 4, written out.
  const double x = 2 * r, decay = std::exp(-x);
  const double q11 = ThirdOrderRemainder(x) / 4;
  const double q12 = decay * r * r / 2;
  const double q22 = (-std::expm1(-x) + decay * (x - x * x / 2)) / 4;
  const double l11 = std::sqrt(q11), l21 = l11 > 0 ? q12 / l11 : 0;
  step.chol << l11, 0, l21, std::sqrt(std::max(0.0, q22 - l21 * l21));
  return step;
}

DrydenGusts::DrydenGusts(std::uint64_t seed, const std::string& name, double correlation)
    : own_(seed, name + "/wind"),
      common_(seed, "wind"),
      own_share_(std::sqrt(1 - correlation)),
      common_share_(std::sqrt(correlation)) {
  // From the stationary distribution.
  u_ = Noise();
  for (Vector2d* state : {&v_, &w_}) {
    for (double& z : *state) z = Noise() / 2;
  }
}

double DrydenGusts::Noise() {
  double noise = own_share_ * own_.Normal();
  if (common_share_ > 0) noise += common_share_ * common_.Normal();
  return noise;
}

Vector3d DrydenGusts::Step(double dt_s, double speed_mps, const DrydenScales& scales) {
  const double r_u = dt_s * speed_mps / scales.L_u_m, r_w = dt_s * speed_mps / scales.L_w_m;
  u_ = std::exp(-r_u) * u_ + std::sqrt(-std::expm1(-2 * r_u)) * Noise();
  const auto advance = [this](double r, Vector2d& z) {
    const GustStep step = GustStepOf(r);
    Vector2d noise;
    for (double& n : noise) n = Noise();
    z = step.phi * z + step.chol * noise;
    return z[0] + std::sqrt(3.0) * z[1];
  };
  const double v = advance(r_u, v_), w = advance(r_w, w_);
  return {scales.sigma_u_mps * u_, scales.sigma_u_mps * v, scales.sigma_w_mps * w};
}

Wind::Wind(const WindConfig& config, std::uint64_t seed, const std::string& name)
    : mean_W_mps_(config.mean_mps.data()),
      w20_mps_(W20_mps(config.turbulence)),
      R_WG_(GustAxes(mean_W_mps_)),
      gusts_(seed, name, config.correlation) {}

Vector3d Wind::Step(double dt_s, double height_m, const Vector3d& v_WB_mps) {
  if (w20_mps_ <= 0) return mean_W_mps_;
  const double speed_mps = std::max({(v_WB_mps - mean_W_mps_).norm(), mean_W_mps_.norm(), 1.0});
  return mean_W_mps_ + R_WG_ * gusts_.Step(dt_s, speed_mps, DrydenScalesAt(height_m, w20_mps_));
}

}  // namespace windhover
