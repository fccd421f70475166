#include "render/mesh_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

using Eigen::Vector3f;

constexpr int kSize_px = 160;  // Of the depth images.

const std::vector<Vector3f>& Directions() {
  static const std::vector<Vector3f> directions = SphereDirections(kSkyDirections);
  return directions;
}

// Greatest height of the mesh along one direction, over a plane across it.
class DepthImage {
 public:
  DepthImage(const Mesh& mesh, const Vector3f& direction)
      : heights_(kSize_px * kSize_px, -std::numeric_limits<float>::infinity()) {
    axes_.row(2) = direction;
    axes_.row(0) = direction.unitOrthogonal();
    axes_.row(1) = direction.cross(axes_.row(0).transpose());
    const Eigen::AlignedBox3f box = BoundingBox(mesh);
    centre_ = box.center();
    scale_ = kSize_px / std::max(box.diagonal().norm() * 1.02f, 1e-6f);
    for (const auto& t : mesh.triangles) {
      Draw(Place(mesh.positions[t[0]]), Place(mesh.positions[t[1]]), Place(mesh.positions[t[2]]));
    }
  }

  /// In pixels across, and pixel widths along the direction.
  Vector3f Place(const Vector3f& p) const {
    return axes_ * (p - centre_) * scale_ + Vector3f(kSize_px / 2.0f, kSize_px / 2.0f, 0);
  }

  bool IsOpen(const Vector3f& place, float bias_px) const {
    const int x = std::clamp(static_cast<int>(place.x()), 0, kSize_px - 1);
    const int y = std::clamp(static_cast<int>(place.y()), 0, kSize_px - 1);
    return heights_[static_cast<std::size_t>(y * kSize_px + x)] <= place.z() + bias_px;
  }

 private:
  void Draw(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
    const float area = (b - a).head<2>().x() * (c - a).y() - (b - a).y() * (c - a).x();
    if (std::abs(area) < 1e-9f) return;
    const auto low = [](float p, float q, float r) {
      return std::max(0, static_cast<int>(std::floor(std::min({p, q, r}))));
    };
    const auto high = [](float p, float q, float r) {
      return std::min(kSize_px - 1, static_cast<int>(std::max({p, q, r})));
    };
    for (int y = low(a.y(), b.y(), c.y()); y <= high(a.y(), b.y(), c.y()); ++y) {
      for (int x = low(a.x(), b.x(), c.x()); x <= high(a.x(), b.x(), c.x()); ++x) {
        const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
        const float wb = ((px - a.x()) * (c.y() - a.y()) - (py - a.y()) * (c.x() - a.x())) / area;
        const float wc = ((b.x() - a.x()) * (py - a.y()) - (b.y() - a.y()) * (px - a.x())) / area;
        if (wb < 0 || wc < 0 || wb + wc > 1) continue;
        float& height = heights_[static_cast<std::size_t>(y * kSize_px + x)];
        height = std::max(height, a.z() + wb * (b.z() - a.z()) + wc * (c.z() - a.z()));
      }
    }
  }

  Eigen::Matrix3f axes_;
  Vector3f centre_;
  float scale_;
  std::vector<float> heights_;
};

}  // namespace

std::vector<std::uint64_t> OpenDirections(const Mesh& surface, const Mesh& points) {
  std::vector<std::uint64_t> open(points.positions.size());
  const float to_surface_m = BoundingBox(surface).diagonal().norm() / kSize_px;
  for (int i = 0; i < kSkyDirections; ++i) {
    const DepthImage depth(surface, Directions()[static_cast<std::size_t>(i)]);
    for (std::size_t v = 0; v < open.size(); ++v) {
      // From a little outside, so that a surface does not shade itself.
      const Vector3f p = points.positions[v] + points.normals[v] * to_surface_m;
      open[v] |= std::uint64_t{depth.IsOpen(depth.Place(p), 1.5f)} << i;
    }
  }
  return open;
}

float AmbientOpenness(std::uint64_t open, const Vector3f& normal) {
  float sum = 0, total = 1e-6f;
  for (std::size_t i = 0; i < kSkyDirections; ++i) {
    const float weight = std::max(normal.dot(Directions()[i]), 0.0f);
    total += weight;
    if ((open >> i & 1) != 0) sum += weight;
  }
  return sum / total;
}

OpennessTowards::OpennessTowards(const Vector3f& d) {
  for (int i = 0; i < kSkyDirections; ++i) {
    const float beyond = d.dot(Directions()[static_cast<std::size_t>(i)]) - 0.87f;
    if (!(beyond > 0)) continue;
    near_.push_back({i, beyond * beyond});
    total_ += beyond * beyond;
  }
}

float OpennessTowards::Of(std::uint64_t open) const {
  float sum = 0;
  for (const Direction& direction : near_) {
    if ((open >> direction.index & 1) != 0) sum += direction.weight;
  }
  return sum / total_;
}

}  // namespace windhover
