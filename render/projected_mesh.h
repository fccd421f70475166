#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "camera/any_camera.h"
#include "render/mesh.h"
#include "render/row_poses.h"

namespace windhover {

/// A rectangle of pixels: columns [x0, x0 + width), rows [y0, y0 + height).
struct PixelRect {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  bool IsEmpty() const { return width <= 0 || height <= 0; }
};

/// A vertex in the image; not valid where the lens does not see it.
struct ImageVertex {
  double x_px = 0, y_px = 0, inverse_depth = 0;
  bool is_valid = false;
};

struct ProjectedMesh {
  std::vector<ImageVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Those whose vertices are all valid.
};

/// `mesh` as the camera sees it, its rows one after the other.
ProjectedMesh Project(const Mesh& mesh, const AnyCamera& camera, const RowPoses& X_CB);

/// Bounds of what is drawn.
struct ImageBounds {
  double x_min = 1e9, x_max = -1e9, y_min = 1e9, y_max = -1e9;
  double inverse_near = 0, inverse_far = 1e9;

  void Extend(const ProjectedMesh& mesh);
  void Extend(const ImageBounds& other);
  void Grow(double margin_px);
  double Extent_px() const;
  /// The pixels that they touch of an image, and of as many as `margin_px` around it.
  PixelRect Within(int width_px, int height_px, int margin_px) const;
};

}  // namespace windhover
