#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "camera/any_camera.h"
#include "common/cpu/instruction_set.h"
#include "render/mesh.h"
#include "render/row_poses.h"

namespace windhover {

/// A rectangle of pixels: columns [x0, x0 + width), rows [y0, y0 + height).
struct PixelRect {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  bool IsEmpty() const { return width <= 0 || height <= 0; }
};

/// Bounds of what is drawn.
struct ImageBounds {
  double x_min = 1e9, x_max = -1e9, y_min = 1e9, y_max = -1e9;
  double inverse_near = 0, inverse_far = 1e9;

  void Extend(double x_px, double y_px, double inverse_depth);
  void Extend(const ImageBounds& other);
  void Grow(double margin_px);
  double Extent_px() const;
  /// The pixels that they touch of an image, and of as many as `margin_px` around it.
  PixelRect Within(int width_px, int height_px, int margin_px) const;
};

/// A mesh in the image. Where the lens does not see a vertex, its inverse depth is 0.
struct ProjectedMesh {
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;

  std::vector<double> x_px, y_px, inverse_depth_per_m;  ///< One a vertex.
  ImageBounds bounds;                                   ///< Of what the lens sees.

  /// Those whose vertices it sees; at most as long as the mesh that was projected.
  const Triangles& SeenTriangles() const { return all != nullptr ? *all : seen; }

  const Triangles* all = nullptr;  ///< Of the mesh, if all are seen; else null.
  Triangles seen;                  ///< Otherwise those that are.
};

/// `mesh` as the camera sees it, its rows one after the other.
ProjectedMesh Project(const Mesh& mesh, const AnyCamera& camera, const RowPoses& X_CB,
                      InstructionSet isa = WidestInstructionSet());

}  // namespace windhover
