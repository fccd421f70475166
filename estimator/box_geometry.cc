#include "estimator/box_geometry.h"

#include <cmath>

namespace windhover {

std::optional<BoxGeometry> GeometryOf(const StereoRig& rig, const stereo_box_t& box,
                                      double offset_px) {
  const auto left = rig.left.Unproject({box.left.x_px - offset_px / 2, box.left.y_px});
  const auto right = rig.right.Unproject({box.right.x_px + offset_px / 2, box.right.y_px});
  if (!left || !right || !(left->z() > 0) || !(right->z() > 0)) return std::nullopt;
  const Eigen::Vector3d in_left = *left / left->z(), in_right = *right / right->z();
  const Eigen::Vector3d mean = (in_left + in_right) / 2;
  const double f_px = rig.left.fx_px();
  BoxGeometry geometry;
  geometry.cosine = 1 / mean.norm();
  geometry.direction_R = mean * geometry.cosine;
  geometry.x = mean.x();
  geometry.disparity_px = f_px * (in_left.x() - in_right.x());
  geometry.vertical_px = f_px * (in_left.y() - in_right.y());
  geometry.width_px = std::sqrt(box.left.w_px * box.right.w_px);
  geometry.width = geometry.width_px / f_px;
  geometry.height = std::sqrt(box.left.h_px * box.right.h_px) / f_px;
  return geometry;
}

}  // namespace windhover
