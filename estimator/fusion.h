#pragma once

#include "camera/stereo_rig.h"
#include "estimator/box_geometry.h"
#include "estimator/fitted_priors.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// Log of the distance d that a label would have by the size of boxes alone: size_log_m +
/// width_exponent · log w + height_exponent · log h - log cos θ.
double SizeLog_m(const FittedPriors& priors, const BoxGeometry& geometry);

/// The priors of a rig without labels, from `estimator.offset1_px`, `disparity_sigma_px`,
/// `target_width_m`, `size_sigma`: distances from the rig's middle, sizes by width alone.
FittedPriors UnfittedPriors(const EstimatorConfig& config);

/// `fusion`: one frame's disparity, without its offset, and its size, as two measurements of
/// inverse range, weighted by their information:
///
///     ρ1 = (d - offset) cos θ / (f B)      σ1 = cos θ / (f B) · √(σ_d² + σ_offset²)
///     ρ2 = 1 / (size - lever)              σ2 = ρ · σ_size
///
/// σ2 follows the result, in two rounds. Reported is 1/ρ + lever, σ = σ_ρ / ρ².
class Fusion final : public RangeEstimator {
 public:
  explicit Fusion(const AircraftConfig& config);
  Fusion(const AircraftConfig& config, const FittedPriors& priors);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  FittedPriors priors_;
};

}  // namespace windhover
