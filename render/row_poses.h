#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

namespace windhover {

/// Where a body is in a camera's frame while the rows of an image are exposed one after the
/// other: X_CB at the rows 0, row_step_px, 2 row_step_px …; a single pose holds for all rows.
struct RowPoses {
  std::vector<Eigen::Isometry3d> X_CB;  ///< At least one.
  double row_step_px = 0;

  RowPoses() = default;
  RowPoses(const Eigen::Isometry3d& pose) : X_CB{pose} {}

  bool IsOne() const { return X_CB.size() == 1; }

  /// Of the middle row.
  const Eigen::Isometry3d& Middle() const { return X_CB[X_CB.size() / 2]; }

  /// A point of the body in C when `row` is exposed, in a straight line between rows with a pose.
  Eigen::Vector3d PointAt(double row, const Eigen::Vector3d& p_BQ_m) const {
    const auto last = static_cast<double>(X_CB.size() - 1);
    const double place = std::clamp(row / row_step_px, -last, 2 * last);
    const double before = std::clamp(std::floor(place), 0.0, last - 1);
    const auto i = static_cast<std::size_t>(before);
    const double share = place - before;
    return (1 - share) * (X_CB[i] * p_BQ_m) + share * (X_CB[i + 1] * p_BQ_m);
  }
};

/// The pixel where the camera sees point Q of a body while the row of that very pixel is exposed,
/// or nothing if it does not. If `p_CQ_m` is not null, also writes where Q is then. Found by
/// iteration, which converges as long as the image moves by less than a row in a row's time.
template <typename Camera>
std::optional<Eigen::Vector2d> ProjectByRows(const Camera& camera, const RowPoses& poses,
                                             const Eigen::Vector3d& p_BQ_m,
                                             Eigen::Vector3d* p_CQ_m = nullptr) {
  constexpr int kMaxIterations = 10;
  constexpr double kTolerance_px = 1e-6;
  Eigen::Vector3d point_m = poses.Middle() * p_BQ_m;
  std::optional<Eigen::Vector2d> q_px = camera.Project(point_m);
  for (int i = 0; i < kMaxIterations && !poses.IsOne() && q_px; ++i) {
    const double row = q_px->y();
    point_m = poses.PointAt(row, p_BQ_m);
    q_px = camera.Project(point_m);
    if (q_px && std::abs(q_px->y() - row) < kTolerance_px) break;
  }
  if (p_CQ_m != nullptr) *p_CQ_m = point_m;
  return q_px;
}

}  // namespace windhover
