#include "camera/pinhole_rational.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "camera/newton_undistortion.h"
#include "camera/positive_root.h"

namespace windhover {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Terms = PinholeRational::Terms;

DistortedPoint Distort(const Terms& m, const Vector2d& undistorted) {
  const double x = undistorted.x(), y = undistorted.y();
  const double r2 = x * x + y * y;
  const double over = 1 + r2 * (m.k1 + r2 * (m.k2 + r2 * m.k3));
  const double under = 1 + r2 * (m.k4 + r2 * (m.k5 + r2 * m.k6));
  const double radial = over / under;
  const double d_radial_d_r2 =
      (m.k1 + r2 * (2 * m.k2 + r2 * 3 * m.k3) - radial * (m.k4 + r2 * (2 * m.k5 + r2 * 3 * m.k6))) /
      under;
  const double prism_x = 2 * (m.s1 + 2 * r2 * m.s2);  // d(prism) / dx, divided by x.
  const double prism_y = 2 * (m.s3 + 2 * r2 * m.s4);

  DistortedPoint out;
  out.point << x * radial + 2 * m.p1 * x * y + m.p2 * (r2 + 2 * x * x) + r2 * (m.s1 + r2 * m.s2),
      y * radial + m.p1 * (r2 + 2 * y * y) + 2 * m.p2 * x * y + r2 * (m.s3 + r2 * m.s4);
  const double shear = 2 * x * y * d_radial_d_r2 + 2 * m.p1 * x + 2 * m.p2 * y;
  out.derivative << radial + 2 * x * x * d_radial_d_r2 + 2 * m.p1 * y + 6 * m.p2 * x + prism_x * x,
      shear + prism_x * y, shear + prism_y * x,
      radial + 2 * y * y * d_radial_d_r2 + 6 * m.p1 * y + 2 * m.p2 * x + prism_y * y;
  return out;
}

// With N and D the two polynomials in s = r², the slope d(r N / D) / dr has the numerator
// N D + 2 s (N' D - N D').
double LargestInvertibleR2(const Terms& m) {
  const std::array<double, 4> over = {1, m.k1, m.k2, m.k3}, under = {1, m.k4, m.k5, m.k6};
  std::vector<double> slope(7);
  for (std::size_t i = 0; i < over.size(); ++i) {
    for (std::size_t j = 0; j < under.size(); ++j) {
      slope[i + j] +=
          over[i] * under[j] * (1 + 2 * (static_cast<double>(i) - static_cast<double>(j)));
    }
  }
  return std::min(FirstPositiveRoot(slope), FirstPositiveRoot({under.begin(), under.end()}));
}

}  // namespace

PinholeRational::PinholeRational(const Intrinsics& intrinsics, const Terms& terms)
    : fx_px(intrinsics.fx_px),
      fy_px(intrinsics.fy_px),
      cx_px(intrinsics.cx_px),
      cy_px(intrinsics.cy_px),
      terms_(terms),
      largest_r2_(LargestInvertibleR2(terms)) {}

std::optional<Vector2d> PinholeRational::Project(const Vector3d& p_CQ_m,
                                                 PixelFromPointJacobian* dq_dp) const {
  const double depth_m = p_CQ_m.z();
  if (!(depth_m >= kMinDepth_m)) return std::nullopt;
  const Vector2d undistorted = p_CQ_m.head<2>() / depth_m;
  if (!(undistorted.squaredNorm() < largest_r2_)) return std::nullopt;
  const DistortedPoint distorted = Distort(terms_, undistorted);
  if (!(distorted.derivative.determinant() > 0)) return std::nullopt;

  const Vector2d focal_px(fx_px, fy_px);
  if (dq_dp != nullptr) {
    Eigen::Matrix<double, 2, 3> d_undistorted_dp;
    d_undistorted_dp << Eigen::Matrix2d::Identity(), -undistorted;
    *dq_dp = focal_px.asDiagonal() * distorted.derivative * d_undistorted_dp / depth_m;
  }
  return focal_px.cwiseProduct(distorted.point) + Vector2d(cx_px, cy_px);
}

std::optional<Vector3d> PinholeRational::Unproject(const Vector2d& q_px) const {
  const Vector2d target((q_px.x() - cx_px) / fx_px, (q_px.y() - cy_px) / fy_px);
  Vector2d start = target;
  if (start.squaredNorm() >= largest_r2_) start *= 0.99 * std::sqrt(largest_r2_) / start.norm();
  const auto undistorted = SolveDistortion(
      [this](const Vector2d& point) { return Distort(terms_, point); }, target, start);
  if (!undistorted || !(undistorted->squaredNorm() < largest_r2_) ||
      !(Distort(terms_, *undistorted).derivative.determinant() > 0)) {
    return std::nullopt;
  }
  return undistorted->homogeneous().normalized();
}

}  // namespace windhover
