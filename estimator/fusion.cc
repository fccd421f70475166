#include "estimator/fusion.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kFarthest_m = 1000;

double Square(double x) { return x * x; }

}  // namespace

double SizeLog_m(const FittedPriors& priors, const BoxGeometry& geometry) {
  return priors.size_log_m + priors.width_exponent * std::log(geometry.width) +
         priors.height_exponent * std::log(geometry.height) - std::log(geometry.cosine);
}

FittedPriors UnfittedPriors(const EstimatorConfig& config) {
  FittedPriors priors;
  priors.offset_px = config.offset1_px;
  priors.disparity_sigma_px = std::max(config.disparity_sigma_px, 1e-3);
  priors.size_log_m = std::log(config.target_width_m);
  priors.size_sigma = std::max(config.size_sigma, 1e-3);
  return priors;
}

Fusion::Fusion(const AircraftConfig& config) : Fusion(config, UnfittedPriors(config.estimator)) {}

Fusion::Fusion(const AircraftConfig& config, const FittedPriors& priors)
    : rig_(config.rig.ToStereoRig()), priors_(priors) {}

std::optional<RangeSolution> Fusion::Solve(const StereoObservation& observation) {
  const auto geometry = GeometryOf(rig_, observation.box, priors_.offset_px);
  if (!geometry) return std::nullopt;
  const double per_px = geometry->cosine / (rig_.left.fx_px() * rig_.baseline_m);
  const double by_disparity = geometry->disparity_px * per_px;
  const double disparity_variance =
      Square(per_px) * (Square(priors_.disparity_sigma_px) + Square(priors_.offset_sigma_px) +
                        Square(priors_.disparity_sigma_relative * geometry->width_px));
  const double size_m = std::exp(SizeLog_m(priors_, *geometry));
  const double by_size = 1 / std::max(size_m - priors_.lever_m, 0.1 * size_m);
  double inverse = by_size, variance = 0;
  for (int round = 0; round < 3; ++round) {
    const double size_variance = Square(priors_.size_sigma * inverse);
    variance = 1 / (1 / disparity_variance + 1 / size_variance);
    inverse = variance * (by_disparity / disparity_variance + by_size / size_variance);
    inverse = std::max(inverse, 1 / kFarthest_m);
  }
  const double range_m = 1 / inverse + priors_.lever_m;
  return RangeSolution{range_m * geometry->direction_R, range_m,
                       std::sqrt(variance) / Square(inverse), /*n_stages=*/1};
}

}  // namespace windhover
