#pragma once

#include "camera/stereo_rig.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// `size`: depth = f · target_width_m / w with w the mean width of both boxes, no disparity. The
/// direction is the mean of both rays, in which a disparity offset shared by the two cameras
/// cancels. Its relative uncertainty is that of the width, `estimator.size_sigma`.
class SizePrior final : public RangeEstimator {
 public:
  explicit SizePrior(const AircraftConfig& config);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  double target_width_m_;
  double size_sigma_;
};

}  // namespace windhover
