#include "estimator/triangulation.h"

namespace windhover {

Triangulation::Triangulation(const AircraftConfig& config)
    : rig_(config.rig.ToStereoRig()), disparity_sigma_px_(config.estimator.disparity_sigma_px) {}

std::optional<RangeSolution> Triangulation::Solve(const StereoObservation& observation) {
  const stereo_box_t& box = observation.box;
  const auto point = Triangulate(rig_, {box.left.x_px, box.left.y_px},
                                 {box.right.x_px, box.right.y_px}, disparity_sigma_px_);
  if (!point) return std::nullopt;
  return RangeSolution{point->p_RT_m, point->range_m, point->range_sigma_m};
}

}  // namespace windhover
