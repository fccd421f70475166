#pragma once

#include <vector>

#include "render/projected_mesh.h"
#include "render/triangle_kernel.h"

namespace windhover {

enum class Faces { kFront, kBoth };

/// A projected mesh in steps of samples, made for DrawOpaque and DrawTranslucent.
class RasterMesh {
 public:
  /// Keeps the triangles that may cover samples, with the `faces` that are drawn. `bounds`: of all
  /// that is drawn together.
  void Set(const ProjectedMesh& mesh, Faces faces, const ImageBounds& bounds, int samples_per_px);

  const std::vector<RasterVertex>& Vertices() const { return vertices_; }
  const std::vector<RasterTriangle>& Triangles() const { return triangles_; }
  /// 1 / Z of what is so near, per m.
  double InverseDepthAt(float nearness) const {
    return farthest_ + static_cast<double>(nearness) / per_inverse_;
  }

 private:
  std::vector<RasterVertex> vertices_;
  std::vector<RasterTriangle> triangles_;
  double farthest_ = 0, per_inverse_ = 1;  ///< nearness = (1 / Z - farthest_) per_inverse_.
};

}  // namespace windhover
