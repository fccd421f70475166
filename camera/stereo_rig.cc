#include "camera/stereo_rig.h"

namespace windhover {

using Eigen::Vector2d;
using Eigen::Vector3d;

std::optional<Vector2d> PosedCamera::Project(const Vector3d& p_RQ_m) const {
  // For a rigid transform the inverse is the transpose, without a matrix inversion.
  return camera.Project(X_RC.linear().transpose() * (p_RQ_m - X_RC.translation()));
}

PosedStereoRig Posed(const StereoRig& rig) {
  const Vector3d half_baseline_m(rig.baseline_m / 2, 0, 0);
  PosedStereoRig posed{{rig.left, Eigen::Isometry3d::Identity()},
                       {rig.right, Eigen::Isometry3d::Identity()}};
  posed.left.X_RC.translation() = -half_baseline_m;
  posed.right.X_RC.translation() = half_baseline_m;
  return posed;
}

std::optional<StereoPixels> Project(const PosedStereoRig& rig, const Vector3d& p_RQ_m) {
  const auto left_px = rig.left.Project(p_RQ_m);
  const auto right_px = rig.right.Project(p_RQ_m);
  if (!left_px || !right_px) return std::nullopt;
  return StereoPixels{*left_px, *right_px};
}

std::optional<TriangulatedPoint> Triangulate(const StereoRig& rig, const Vector2d& left_px,
                                             const Vector2d& right_px, double disparity_sigma_px) {
  const auto left_ray = rig.left.Unproject(left_px);
  const auto right_ray = rig.right.Unproject(right_px);
  if (!left_ray || !right_ray) return std::nullopt;
  const Vector2d left = left_ray->hnormalized(), right = right_ray->hnormalized();
  const double disparity = left.x() - right.x();
  if (!(disparity > 0)) return std::nullopt;

  TriangulatedPoint point;
  point.depth_m = rig.baseline_m / disparity;
  point.p_RT_m = point.depth_m * ((left + right) / 2).homogeneous();
  point.range_m = point.p_RT_m.norm();
  const double depth_sigma_m =
      point.depth_m * point.depth_m / (rig.left.fx_px() * rig.baseline_m) * disparity_sigma_px;
  point.range_sigma_m = depth_sigma_m * point.range_m / point.depth_m;
  return point;
}

}  // namespace windhover
