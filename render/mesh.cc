#include "render/mesh.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace windhover {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// Halves long edges once. The midpoint of an edge is made once per pair of vertices.
class EdgeSplitter {
 public:
  EdgeSplitter(Mesh* mesh, float max_edge_m)
      : mesh_(*mesh), max_squared_(max_edge_m * max_edge_m) {}

  /// @return whether any edge was split.
  bool Run() {
    std::vector<Triangle> triangles;
    triangles.reserve(mesh_.triangles.size() * 2);
    for (const Triangle& t : mesh_.triangles) Split(t, &triangles);
    const bool changed = triangles.size() != mesh_.triangles.size();
    mesh_.triangles = std::move(triangles);
    return changed;
  }

 private:
  bool IsLong(std::uint32_t a, std::uint32_t b) const {
    return (mesh_.positions[a] - mesh_.positions[b]).squaredNorm() > max_squared_;
  }

  void Split(const Triangle& t, std::vector<Triangle>* out) {
    const std::array<bool, 3> is_long = {IsLong(t[0], t[1]), IsLong(t[1], t[2]),
                                         IsLong(t[2], t[0])};
    const int count = is_long[0] + is_long[1] + is_long[2];
    if (count == 0) {
      out->push_back(t);
      return;
    }
    // Turn the triangle so that the edges to split come first (or the one not to split last).
    std::size_t first = 0;
    while (!(is_long[first] && (count != 2 || is_long[(first + 1) % 3]))) ++first;
    const std::uint32_t a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3];
    const std::uint32_t ab = Midpoint(a, b);
    if (count == 1) {
      out->insert(out->end(), {{a, ab, c}, {ab, b, c}});
      return;
    }
    const std::uint32_t bc = Midpoint(b, c);
    if (count == 2) {
      out->insert(out->end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
      return;
    }
    const std::uint32_t ca = Midpoint(c, a);
    out->insert(out->end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }

  std::uint32_t Midpoint(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto [entry, is_new] =
        midpoints_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back((mesh_.positions[a] + mesh_.positions[b]) * 0.5f);
      mesh_.base_colours.push_back((mesh_.base_colours[a] + mesh_.base_colours[b]) * 0.5f);
      const Eigen::Vector3f sum = mesh_.normals[a] + mesh_.normals[b];
      mesh_.normals.push_back(sum.squaredNorm() > 1e-6f ? sum.normalized() : mesh_.normals[a]);
    }
    return entry->second;
  }

  Mesh& mesh_;
  float max_squared_;
  std::unordered_map<std::uint64_t, std::uint32_t> midpoints_;
};

}  // namespace

void Append(const Mesh& part, Mesh* mesh) {
  const auto base = static_cast<std::uint32_t>(mesh->positions.size());
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(part.positions, &mesh->positions);
  append(part.normals, &mesh->normals);
  append(part.base_colours, &mesh->base_colours);
  for (const Triangle& t : part.triangles) {
    mesh->triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
}

Eigen::AlignedBox3f BoundingBox(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.positions) box.extend(p);
  return box;
}

Mesh WithShortEdges(Mesh mesh, float max_edge_m, std::size_t max_triangles) {
  while (mesh.triangles.size() < max_triangles && EdgeSplitter(&mesh, max_edge_m).Run()) {
  }
  return mesh;
}

std::vector<Eigen::Vector3f> SphereDirections(int count) {
  const double golden_angle_rad = EIGEN_PI * (3 - std::sqrt(5.0));
  std::vector<Eigen::Vector3f> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    directions.emplace_back(
        Eigen::Vector3d(r * std::cos(i * golden_angle_rad), r * std::sin(i * golden_angle_rad), z)
            .cast<float>());
  }
  return directions;
}

std::vector<std::uint32_t> ExtremeVertices(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<Eigen::Vector3f> directions = SphereDirections(4096);
  for (int axis = 0; axis < 3; ++axis) {
    directions.push_back(Eigen::Vector3f::Unit(axis));
    directions.push_back(-Eigen::Vector3f::Unit(axis));
  }
  std::vector<std::uint32_t> extreme;
  for (const Eigen::Vector3f& d : directions) {
    if (positions.empty()) break;
    std::uint32_t best = 0;
    for (std::uint32_t i = 1; i < positions.size(); ++i) {
      if (positions[i].dot(d) > positions[best].dot(d)) best = i;
    }
    extreme.push_back(best);
  }
  std::sort(extreme.begin(), extreme.end());
  extreme.erase(std::unique(extreme.begin(), extreme.end()), extreme.end());
  return extreme;
}

}  // namespace windhover
