#include "render/projected_mesh.h"

#include <algorithm>
#include <cmath>

namespace windhover {

ProjectedMesh Project(const Mesh& mesh, const AnyCamera& camera, const RowPoses& X_CB) {
  constexpr double kNear_m = 0.05;
  ProjectedMesh projected;
  projected.vertices.reserve(mesh.positions.size());
  bool all_valid = true;
  camera.Visit([&](const auto& model) {
    for (const Eigen::Vector3f& p_B : mesh.positions) {
      Eigen::Vector3d p_C;
      auto q_px = ProjectByRows(model, X_CB, p_B.cast<double>(), &p_C);
      if (!(p_C.z() > kNear_m)) q_px.reset();
      all_valid = all_valid && q_px.has_value();
      projected.vertices.push_back(q_px ? ImageVertex{q_px->x(), q_px->y(), 1 / p_C.z(), true}
                                        : ImageVertex{});
    }
  });
  if (all_valid) {
    projected.triangles = mesh.triangles;
    return projected;
  }
  for (const auto& t : mesh.triangles) {
    const auto& v = projected.vertices;
    if (v[t[0]].is_valid && v[t[1]].is_valid && v[t[2]].is_valid) projected.triangles.push_back(t);
  }
  return projected;
}

void ImageBounds::Extend(const ProjectedMesh& mesh) {
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) {
      const ImageVertex& v = mesh.vertices[i];
      x_min = std::min(x_min, v.x_px);
      x_max = std::max(x_max, v.x_px);
      y_min = std::min(y_min, v.y_px);
      y_max = std::max(y_max, v.y_px);
      inverse_near = std::max(inverse_near, v.inverse_depth);
      inverse_far = std::min(inverse_far, v.inverse_depth);
    }
  }
}

void ImageBounds::Extend(const ImageBounds& other) {
  x_min = std::min(x_min, other.x_min);
  x_max = std::max(x_max, other.x_max);
  y_min = std::min(y_min, other.y_min);
  y_max = std::max(y_max, other.y_max);
  inverse_near = std::max(inverse_near, other.inverse_near);
  inverse_far = std::min(inverse_far, other.inverse_far);
}

void ImageBounds::Grow(double margin_px) {
  x_min -= margin_px;
  y_min -= margin_px;
  x_max += margin_px;
  y_max += margin_px;
}

double ImageBounds::Extent_px() const { return std::max(x_max - x_min, y_max - y_min); }

PixelRect ImageBounds::Within(int width_px, int height_px, int margin_px) const {
  if (x_min > x_max) return {};
  // From the first to the last pixel, as far as `size` pixels and the margins reach.
  const auto range = [margin_px](double low, double high, int size) {
    const double first = -margin_px, last = size + margin_px - 1;
    return std::array{static_cast<int>(std::floor(std::clamp(low, first, last + 1) + 0.5)),
                      static_cast<int>(std::floor(std::clamp(high, first - 1, last) + 0.5))};
  };
  const auto [x0, x1] = range(x_min, x_max, width_px);
  const auto [y0, y1] = range(y_min, y_max, height_px);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

}  // namespace windhover
