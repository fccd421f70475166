#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "camera/any_camera.h"
#include "render/row_poses.h"

namespace windhover {

/// Sub-exposures in a row for which one drawing of a target stands.
struct DrawnPart {
  std::size_t first = 0;
  std::size_t drawn = 0;                   ///< The sub-exposure whose pose is drawn.
  std::vector<Eigen::Vector2d> shifts_px;  ///< How the image moves from there, one each.

  double LargestShift_px() const;
};

/// Divides an exposure into the fewest equal parts during each of which what is in `box_B` moves
/// in the image as a whole, but for at most `max_blur_px` from first to last; into single
/// sub-exposures where the lens does not see all of the box.
std::vector<DrawnPart> DivideExposure(const Eigen::AlignedBox3f& box_B, const AnyCamera& camera,
                                      std::span<const RowPoses> X_CB, double max_blur_px);

}  // namespace windhover
