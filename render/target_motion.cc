#include "render/target_motion.h"

#include <algorithm>
#include <array>
#include <optional>

namespace windhover {
namespace {

constexpr int kCorners = 8;
constexpr double kMaxShift_px = 128;

using Corners = std::array<Eigen::Vector2d, kCorners>;

// Where the corners of the box are seen in each pose; nothing if the lens does not see one.
std::optional<std::vector<Corners>> CornersOf(const Eigen::AlignedBox3f& box,
                                              const AnyCamera& camera,
                                              std::span<const RowPoses> X_CB) {
  std::vector<Corners> all;
  for (const RowPoses& pose : X_CB) {
    Corners corners;
    for (int i = 0; i < kCorners; ++i) {
      const Eigen::Vector3d p_B =
          box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>();
      const auto q_px = ProjectByRows(camera, pose, p_B);
      if (!q_px) return std::nullopt;
      corners[static_cast<std::size_t>(i)] = *q_px;
    }
    all.push_back(corners);
  }
  return all;
}

DrawnPart Single(std::size_t i) { return {i, i, {Eigen::Vector2d::Zero()}}; }

// Sub-exposures [first, end) as one part; nothing if its corners move too unlike. What is left goes
// evenly to both sides of the middle pose, so that its mean is in the drawing.
std::optional<DrawnPart> AsOne(const std::vector<Corners>& corners, std::size_t first,
                               std::size_t end, double max_blur_px) {
  DrawnPart part{first, (first + end) / 2, {}};
  for (std::size_t i = first; i < end; ++i) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < kCorners; ++k) {
      mean += (corners[i][k] - corners[part.drawn][k]) / kCorners;
    }
    for (std::size_t k = 0; k < kCorners; ++k) {
      const double rest_px = (corners[i][k] - corners[part.drawn][k] - mean).norm();
      if (2 * rest_px > max_blur_px) return std::nullopt;
    }
    part.shifts_px.push_back(mean);
  }
  if (part.LargestShift_px() > kMaxShift_px) return std::nullopt;
  return part;
}

}  // namespace

double DrawnPart::LargestShift_px() const {
  double largest = 0;
  for (const Eigen::Vector2d& shift_px : shifts_px) largest = std::max(largest, shift_px.norm());
  return largest;
}

std::vector<DrawnPart> DivideExposure(const Eigen::AlignedBox3f& box_B, const AnyCamera& camera,
                                      std::span<const RowPoses> X_CB, double max_blur_px) {
  const std::size_t n = X_CB.size();
  const auto corners = CornersOf(box_B, camera, X_CB);
  std::vector<DrawnPart> parts;
  for (std::size_t n_parts = corners ? 1 : n; n_parts < n; ++n_parts) {
    parts.clear();
    for (std::size_t i = 0; i < n_parts; ++i) {
      auto part = AsOne(*corners, i * n / n_parts, (i + 1) * n / n_parts, max_blur_px);
      if (!part) break;
      parts.push_back(std::move(*part));
    }
    if (parts.size() == n_parts) return parts;
  }
  parts.clear();
  for (std::size_t i = 0; i < n; ++i) parts.push_back(Single(i));
  return parts;
}

}  // namespace windhover
