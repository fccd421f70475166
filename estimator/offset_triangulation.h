#pragma once

#include "camera/stereo_rig.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// `offset1`: triangulation with one constant disparity, `estimator.offset1_px`, taken away
/// first, half in each image. It undoes principal points that are not where the calibration has
/// them, the largest error of the paper's rig. The constant is what a scored calibration flight
/// reports as methods.baseline.disparity_offset_px.
class OffsetTriangulation final : public RangeEstimator {
 public:
  explicit OffsetTriangulation(const AircraftConfig& config);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  double offset_px_;
  double disparity_sigma_px_;
};

}  // namespace windhover
