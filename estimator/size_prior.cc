#include "estimator/size_prior.h"

namespace windhover {

SizePrior::SizePrior(const AircraftConfig& config)
    : rig_(config.rig.ToStereoRig()),
      target_width_m_(config.estimator.target_width_m),
      size_sigma_(config.estimator.size_sigma) {}

std::optional<RangeSolution> SizePrior::Solve(const StereoObservation& observation) {
  const stereo_box_t& box = observation.box;
  const auto left = rig_.left.Unproject({box.left.x_px, box.left.y_px});
  const auto right = rig_.right.Unproject({box.right.x_px, box.right.y_px});
  if (!left || !right) return std::nullopt;
  const double width_px = (box.left.w_px + box.right.w_px) / 2;
  const double depth_m = rig_.left.fx_px() * target_width_m_ / width_px;
  // Half a baseline to either side of R's origin: the two lateral shifts cancel in the mean.
  const Eigen::Vector3d p_RT_m = depth_m * (*left / left->z() + *right / right->z()) / 2;
  const double range_m = p_RT_m.norm();
  return RangeSolution{p_RT_m, range_m, range_m * size_sigma_};
}

}  // namespace windhover
