#pragma once

#include <vector>

#include "camera/stereo_rig.h"
#include "estimator/disparity_noise.h"
#include "estimator/fitted_priors.h"
#include "estimator/range_estimator.h"
#include "estimator/self_calibration_bank.h"
#include "estimator/vertical_alignment.h"

namespace windhover {

/// What the filters of a rig expect, and in how many ways (docs/estimation.md).
struct SelfCalibrationSetup {
  FittedPriors priors;
  SelfCalibrationModel model;
  std::vector<SelfCalibrationHypothesis> hypotheses;
};

/// Of a rig without labels: what `estimator` of the scenario says, offset and size in doubt.
SelfCalibrationSetup UnfittedSetup(const AircraftConfig& config);

/// Of a rig with labels: most probably it is as it was then; or the target is another, or the
/// rig was touched, by as much as `estimator.selfcal` says.
SelfCalibrationSetup FittedSetup(const AircraftConfig& config, const FittedPriors& priors);

/// `selfcal` (without labels), `fused` (with the priors of a card): a recursive filter over each
/// target's range, speed and size and the disparity offset of the rig, fed by disparities and box
/// sizes (estimator/self_calibration_bank.h). Own motion is navigation's. Pairs of boxes at
/// heights that do not belong together count less (estimator/vertical_alignment.h).
///
/// Reported is range + priors.lever_m: without labels, the range from the rig's middle.
///
/// Relative yaw is not told apart from the offset: over the image they differ by f · yaw · x²,
/// 4 % of the offset at the border, a fraction of the boxes' noise.
class SelfCalibration final : public RangeEstimator {
 public:
  SelfCalibration(const AircraftConfig& config, const SelfCalibrationSetup& setup);

  /// Measured minus true disparity, as far as known.
  double offset_px() const { return priors_.offset_px + bank_.offset_px(); }
  double offset_sigma_px() const { return bank_.offset_sigma_px(); }
  const VerticalAlignment& vertical() const { return vertical_; }

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  FittedPriors priors_;
  double gate_sigma_;
  SelfCalibrationBank bank_;
  DisparityNoise noise_;
  VerticalAlignment vertical_;
};

}  // namespace windhover
