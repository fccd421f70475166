#pragma once

#include <span>
#include <vector>

#include "render/projected_mesh.h"
#include "render/triangle_kernel.h"

namespace windhover {

/// A projected mesh in steps of samples, made for DrawOpaque and DrawTranslucent.
class RasterMesh {
 public:
  /// `bounds`: of all that is drawn together. Refers to `mesh`.
  void Set(const ProjectedMesh& mesh, const ImageBounds& bounds, int samples_per_px);

  const std::vector<RasterVertex>& Vertices() const { return vertices_; }
  /// Those that are seen, but for some that reach beyond RasterVertex::kMaxPlace.
  std::span<const VertexTriple> Triangles() const { return triangles_; }

 private:
  std::vector<RasterVertex> vertices_;
  std::span<const VertexTriple> triangles_;
  std::vector<VertexTriple> in_reach_;
};

}  // namespace windhover
