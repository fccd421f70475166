#include "render/raster_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace windhover {
namespace {

constexpr double kReach = RasterVertex::kMaxPlace;

// Nearest step of a place; rounded by truncation of what is positive.
std::int32_t StepAt(double place_px, double steps_per_px) {
  const double place = (place_px + 0.5) * steps_per_px;
  const double bounded = place < -kReach ? -kReach : place > kReach ? kReach : place;
  return static_cast<std::int32_t>(bounded + (kReach + 0.5)) - RasterVertex::kMaxPlace;
}

// Vertices out of reach stay at its end, and their triangles are left out.
bool IsInReach(const RasterVertex& v) {
  return std::max(std::abs(v.x), std::abs(v.y)) < RasterVertex::kMaxPlace;
}

}  // namespace

void RasterMesh::Set(const ProjectedMesh& mesh, Faces faces, const ImageBounds& bounds,
                     int samples_per_px) {
  const double steps_per_px = static_cast<double>(samples_per_px) * kSampleSteps;
  const double farthest = bounds.inverse_far - 1e-3 * bounds.inverse_near;
  const double per_inverse = 1 / (bounds.inverse_near - farthest);
  farthest_ = farthest;
  per_inverse_ = per_inverse;
  vertices_.resize(mesh.x_px.size());
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    vertices_[i] = {StepAt(mesh.x_px[i], steps_per_px), StepAt(mesh.y_px[i], steps_per_px),
                    static_cast<float>((mesh.inverse_depth_per_m[i] - farthest) * per_inverse)};
  }
  triangles_.clear();
  for (const auto& t : mesh.SeenTriangles()) {
    const RasterVertex &a = vertices_[t[0]], &b = vertices_[t[1]], &c = vertices_[t[2]];
    const std::int64_t area = FacingArea(a, b, c);
    if (area == 0 || (area < 0 && faces == Faces::kFront)) continue;
    const int first_row = FirstSampleAt(std::min({a.y, b.y, c.y}));
    const int last_row = LastSampleAt(std::max({a.y, b.y, c.y}));
    const bool has_columns =
        FirstSampleAt(std::min({a.x, b.x, c.x})) <= LastSampleAt(std::max({a.x, b.x, c.x}));
    if (first_row > last_row || !has_columns) continue;
    if (!IsInReach(a) || !IsInReach(b) || !IsInReach(c)) continue;
    triangles_.push_back(
        {{t[0], area > 0 ? t[1] : t[2], area > 0 ? t[2] : t[1]}, first_row, last_row});
  }
}

}  // namespace windhover
