#include "estimator/offset_triangulation.h"

namespace windhover {

OffsetTriangulation::OffsetTriangulation(const AircraftConfig& config)
    : rig_(config.rig.ToStereoRig()),
      offset_px_(config.estimator.offset1_px),
      disparity_sigma_px_(config.estimator.disparity_sigma_px) {}

std::optional<RangeSolution> OffsetTriangulation::Solve(const StereoObservation& observation) {
  const stereo_box_t& box = observation.box;
  const auto point =
      Triangulate(rig_, {box.left.x_px - offset_px_ / 2, box.left.y_px},
                  {box.right.x_px + offset_px_ / 2, box.right.y_px}, disparity_sigma_px_);
  if (!point) return std::nullopt;
  return RangeSolution{point->p_RT_m, point->range_m, point->range_sigma_m, /*n_stages=*/1};
}

}  // namespace windhover
