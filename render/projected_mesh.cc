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

void ImageBounds::Grow(double margin_px) {
  x_min -= margin_px;
  y_min -= margin_px;
  x_max += margin_px;
  y_max += margin_px;
}

double ImageBounds::Extent_px() const { return std::max(x_max - x_min, y_max - y_min); }

PixelRect ImageBounds::Within(int width_px, int height_px) const {
  if (x_min > x_max) return {};
  const auto first = [](double low) {
    return static_cast<int>(std::floor(std::max(low, -1.0) + 0.5));
  };
  const auto last = [](double high, int size) {
    return static_cast<int>(std::floor(std::min(high, size + 1.0) + 0.5));
  };
  const int x0 = std::max(first(x_min), 0), x1 = std::min(last(x_max, width_px), width_px - 1);
  const int y0 = std::max(first(y_min), 0), y1 = std::min(last(y_max, height_px), height_px - 1);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

}  // namespace windhover
