#pragma once

#include "camera/stereo_rig.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// `baseline`: the rays through the two box centres meet at the target, as the calibrated rig
/// has it (camera/stereo_rig.h). The paper's Baseline.
class Triangulation final : public RangeEstimator {
 public:
  explicit Triangulation(const AircraftConfig& config);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  double disparity_sigma_px_;
};

}  // namespace windhover
