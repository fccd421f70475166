#include "render/mesh.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace windhover {
namespace {

using Eigen::Vector3f;
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

// Directions at most `width` (as a distance) from an axis.
struct Cone {
  Vector3f axis;
  float width = 0;
  std::vector<Vector3f> directions;
};

// Each of `directions` with the nearest of `axes`.
std::vector<Cone> DividedAmong(const std::vector<Vector3f>& axes,
                               const std::vector<Vector3f>& directions) {
  std::vector<Cone> cones;
  for (const Vector3f& axis : axes) cones.push_back({axis, 0, {}});
  for (const Vector3f& d : directions) {
    Cone* nearest = &cones.front();
    for (Cone& cone : cones) {
      if (cone.axis.dot(d) > nearest->axis.dot(d)) nearest = &cone;
    }
    nearest->width = std::max(nearest->width, (d - nearest->axis).norm());
    nearest->directions.push_back(d);
  }
  return cones;
}

// The vertices that may be the farthest in one of the cone's directions.
std::vector<std::uint32_t> FarthestIn(const Cone& cone, const std::vector<Vector3f>& positions,
                                      const Eigen::AlignedBox3f& box) {
  std::vector<float> along(positions.size());
  const Vector3f centre = box.center();
  for (std::size_t i = 0; i < along.size(); ++i) along[i] = (positions[i] - centre).dot(cone.axis);
  // Off the axis a vertex gains, and the farthest loses, at most radius · width; and rounding.
  const float radius = box.diagonal().norm() / 2;
  const float least =
      *std::max_element(along.begin(), along.end()) - radius * (2 * cone.width + 1e-4f);
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t i = 0; i < along.size(); ++i) {
    if (along[i] >= least) candidates.push_back(i);
  }
  return candidates;
}

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

std::vector<std::uint32_t> ExtremeVertices(const std::vector<Vector3f>& positions) {
  if (positions.empty()) return {};
  std::vector<Vector3f> directions = SphereDirections(4096);
  for (int axis = 0; axis < 3; ++axis) {
    directions.push_back(Vector3f::Unit(axis));
    directions.push_back(-Vector3f::Unit(axis));
  }
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : positions) box.extend(p);
  std::vector<std::uint32_t> extreme;
  for (const Cone& cone : DividedAmong(SphereDirections(256), directions)) {
    const auto candidates = FarthestIn(cone, positions, box);
    for (const Vector3f& d : cone.directions) {
      extreme.push_back(*std::max_element(candidates.begin(), candidates.end(),
                                          [&](std::uint32_t a, std::uint32_t b) {
                                            return positions[a].dot(d) < positions[b].dot(d);
                                          }));
    }
  }
  std::sort(extreme.begin(), extreme.end());
  extreme.erase(std::unique(extreme.begin(), extreme.end()), extreme.end());
  return extreme;
}

}  // namespace windhover
