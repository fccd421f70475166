#include "render/mesh_topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace windhover {
namespace {

// For each vertex the first one of the same place, in the order of places.
std::vector<std::uint32_t> Places(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const Eigen::Vector3f& p = positions[i];
    return std::tuple(p.x(), p.y(), p.z());
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(key(a), a) < std::pair(key(b), b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

struct Edge {
  std::uint32_t low, high;
  bool upwards;  ///< Walked from low to high.
};

std::vector<Edge> SortedEdges(const Mesh& mesh, const std::vector<std::uint32_t>& places) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = places[t[k]], b = places[t[(k + 1) % 3]];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tuple(a.low, a.high, a.upwards) < std::tuple(b.low, b.high, b.upwards);
  });
  return edges;
}

void CountEdges(const std::vector<Edge>& edges, MeshTopology* out) {
  for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    const Edge& edge = edges[begin];
    while (end < edges.size() && edges[end].low == edge.low && edges[end].high == edge.high) ++end;
    const std::size_t n = end - begin;
    out->open_edges += n == 1;
    out->branching_edges += n > 2;
    out->turned_edges += n == 2 && edge.upwards == edges[end - 1].upwards;
  }
}

class Parts {
 public:
  explicit Parts(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t Of(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(std::uint32_t a, std::uint32_t b) { parent_[Of(a)] = Of(b); }

 private:
  std::vector<std::uint32_t> parent_;
};

// The volume that a part encloses is negative if its triangles face inwards.
void CountParts(const Mesh& mesh, const std::vector<std::uint32_t>& places, MeshTopology* out) {
  Parts parts(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    parts.Join(places[t[0]], places[t[1]]);
    parts.Join(places[t[1]], places[t[2]]);
  }
  std::vector<double> volume(mesh.positions.size());
  std::vector<char> is_part(mesh.positions.size());
  const Eigen::Vector3d centre = BoundingBox(mesh).center().cast<double>();
  for (const auto& t : mesh.triangles) {
    const std::uint32_t part = parts.Of(places[t[0]]);
    const auto at = [&](std::size_t k) {
      return Eigen::Vector3d(mesh.positions[t[k]].cast<double>() - centre);
    };
    is_part[part] = 1;
    volume[part] += at(0).dot(at(1).cross(at(2)));
  }
  for (std::size_t i = 0; i < is_part.size(); ++i) {
    out->parts += is_part[i] != 0;
    out->inverted += is_part[i] != 0 && volume[i] < 0;
  }
}

}  // namespace

MeshTopology TopologyOf(const Mesh& mesh) {
  MeshTopology topology;
  const std::vector<std::uint32_t> places = Places(mesh.positions);
  for (std::uint32_t i = 0; i < places.size(); ++i) topology.vertices += places[i] == i;
  CountEdges(SortedEdges(mesh, places), &topology);
  CountParts(mesh, places, &topology);
  return topology;
}

bool TurnOutwards(Mesh* mesh) {
  const MeshTopology topology = TopologyOf(*mesh);
  if (!topology.IsWatertight()) return false;
  if (topology.inverted == 0) return true;
  if (topology.inverted != topology.parts) return false;
  double agreement = 0;
  for (auto& t : mesh->triangles) {
    std::swap(t[1], t[2]);
    const Eigen::Vector3f &a = mesh->positions[t[0]], &b = mesh->positions[t[1]],
                          &c = mesh->positions[t[2]];
    agreement += (b - a).cross(c - a).dot(mesh->normals[t[0]]);
  }
  if (agreement < 0) {
    for (Eigen::Vector3f& n : mesh->normals) n = -n;
  }
  return true;
}

}  // namespace windhover
