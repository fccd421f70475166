#include "render/raster_mesh.h"

#include <algorithm>
#include <cmath>

namespace windhover {
namespace {

constexpr double kReach = RasterVertex::kMaxPlace;

// Nearest step of a place; rounded by truncation of what is positive.
std::int32_t StepAt(double place_px, double steps_per_px) {
  const double place = (place_px + 0.5) * steps_per_px;
  const double bounded = place < -kReach ? -kReach : place > kReach ? kReach : place;
  return static_cast<std::int32_t>(bounded + (kReach + 0.5)) - RasterVertex::kMaxPlace;
}

}  // namespace

void RasterMesh::Set(const ProjectedMesh& mesh, const ImageBounds& bounds, int samples_per_px) {
  const double steps_per_px = static_cast<double>(samples_per_px) * kSampleSteps;
  const double margin = 1e-3 * bounds.inverse_near, farthest = bounds.inverse_far - margin;
  const double per_inverse = 1 / (bounds.inverse_near - farthest);
  vertices_.resize(mesh.x_px.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    vertices_[i] = {StepAt(mesh.x_px[i], steps_per_px), StepAt(mesh.y_px[i], steps_per_px),
                    static_cast<float>((mesh.inverse_depth_per_m[i] - farthest) * per_inverse)};
  }
  triangles_ = mesh.SeenTriangles();
  const double reach_px = kReach / steps_per_px - 1;
  if (std::max({-bounds.x_min, bounds.x_max, -bounds.y_min, bounds.y_max}) < reach_px) return;
  const auto is_near = [&](std::uint32_t i) {
    return std::abs(mesh.x_px[i]) < reach_px && std::abs(mesh.y_px[i]) < reach_px;
  };
  in_reach_.clear();
  for (const VertexTriple& t : triangles_) {
    if (is_near(t[0]) && is_near(t[1]) && is_near(t[2])) in_reach_.push_back(t);
  }
  triangles_ = in_reach_;
}

}  // namespace windhover
