#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "camera/any_camera.h"
#include "common/cpu/instruction_set.h"
#include "render/row_poses.h"

namespace windhover {

/// The points of a body that can bound its silhouette, in B, m.
class Outline {
 public:
  Outline() = default;
  Outline(const std::vector<Eigen::Vector3d>& points_B_m);

  /// Around the pixels that see a point while their row is exposed (ProjectByRows), to the bit;
  /// empty if none does. Through a pinhole without rows eight points at a time.
  Eigen::AlignedBox2d BoxThrough(const AnyCamera& camera, const RowPoses& X_CB,
                                 InstructionSet instructions = WidestInstructionSet()) const;

 private:
  std::vector<double> x_m_, y_m_, z_m_;  ///< The last point again, up to whole lanes.
  std::size_t n_points_ = 0;
};

}  // namespace windhover
