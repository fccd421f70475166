#include "camera/kannala_brandt.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "camera/positive_root.h"

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Terms = KannalaBrandt::Terms;

// θ' and its derivative.
struct DistortedAngle {
  double value, slope;
};

DistortedAngle Distort(const Terms& m, double angle_rad) {
  const double s = angle_rad * angle_rad;
  return {angle_rad * (1 + s * (m.k1 + s * (m.k2 + s * (m.k3 + s * m.k4)))),
          1 + s * (3 * m.k1 + s * (5 * m.k2 + s * (7 * m.k3 + s * 9 * m.k4)))};
}

double LargestInvertibleAngle(const Terms& m) {
  const double fold = FirstPositiveRoot({1, 3 * m.k1, 5 * m.k2, 7 * m.k3, 9 * m.k4});
  return std::min(std::sqrt(fold), std::numbers::pi / 2);
}

// θ for `distorted`, which is below the largest: Newton's method, kept between bounds that close.
double Undistort(const Terms& m, double distorted, double largest_rad) {
  constexpr int kMaxIterations = 100;
  double low = 0, high = largest_rad;
  double angle_rad = std::min(distorted, largest_rad / 2);
  for (int i = 0; i < kMaxIterations; ++i) {
    const DistortedAngle at = Distort(m, angle_rad);
    (at.value < distorted ? low : high) = angle_rad;
    double next = angle_rad - (at.value - distorted) / at.slope;
    if (!(next > low && next < high)) next = low + (high - low) / 2;
    if (std::abs(next - angle_rad) <= 1e-16 * largest_rad) return next;
    angle_rad = next;
  }
  return angle_rad;
}

}  // namespace

KannalaBrandt::KannalaBrandt(const Intrinsics& intrinsics, const Terms& terms)
    : fx_px(intrinsics.fx_px),
      fy_px(intrinsics.fy_px),
      cx_px(intrinsics.cx_px),
      cy_px(intrinsics.cy_px),
      terms_(terms),
      largest_angle_rad_(LargestInvertibleAngle(terms)),
      largest_distorted_(Distort(terms, largest_angle_rad_).value) {}

std::optional<Vector2d> KannalaBrandt::Project(const Vector3d& p_CQ_m,
                                               PixelFromPointJacobian* dq_dp) const {
  const double depth_m = p_CQ_m.z();
  if (!(depth_m >= kMinDepth_m)) return std::nullopt;
  const double offset_m = p_CQ_m.head<2>().norm();
  const double angle_rad = std::atan2(offset_m, depth_m);
  if (!(angle_rad < largest_angle_rad_)) return std::nullopt;
  const DistortedAngle distorted = Distort(terms_, angle_rad);
  const bool is_on_axis = offset_m == 0;
  const double per_m = is_on_axis ? 1 / depth_m : distorted.value / offset_m;

  const Vector2d focal_px(fx_px, fy_px);
  if (dq_dp != nullptr) {
    // Around the axis the image turns with the point; away from it θ' grows.
    const Vector2d away = is_on_axis ? Vector2d(0, 0) : Vector2d(p_CQ_m.head<2>() / offset_m);
    const double distance2_m2 = p_CQ_m.squaredNorm();
    PixelFromPointJacobian d_point_dp;
    d_point_dp.leftCols<2>() = per_m * (Eigen::Matrix2d::Identity() - away * away.transpose()) +
                               distorted.slope * depth_m / distance2_m2 * away * away.transpose();
    d_point_dp.col(2) = -distorted.slope * offset_m / distance2_m2 * away;
    *dq_dp = focal_px.asDiagonal() * d_point_dp;
  }
  return focal_px.cwiseProduct(per_m * p_CQ_m.head<2>()) + Vector2d(cx_px, cy_px);
}

std::optional<Vector3d> KannalaBrandt::Unproject(const Vector2d& q_px) const {
  const Vector2d target((q_px.x() - cx_px) / fx_px, (q_px.y() - cy_px) / fy_px);
  const double distorted = target.norm();
  if (!(distorted < largest_distorted_)) return std::nullopt;
  if (distorted == 0) return Vector3d::UnitZ();
  const double angle_rad = Undistort(terms_, distorted, largest_angle_rad_);
  if (!(std::cos(angle_rad) > 0)) return std::nullopt;
  Vector3d ray_C;
  ray_C << std::sin(angle_rad) / distorted * target, std::cos(angle_rad);
  return ray_C;
}

}  // namespace windhover
