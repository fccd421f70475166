#pragma once

#include <cstdint>
#include <vector>

#include "render/mesh.h"

namespace windhover {

/// Number of directions in which a vertex's view of its surroundings is known.
inline constexpr int kSkyDirections = 64;

/// For each vertex of `points` a bit per direction of SphereDirections(kSkyDirections): whether
/// `surface` leaves that direction open. Found by drawing its depth along each direction.
/// `points` is the same surface, perhaps with shorter edges.
std::vector<std::uint64_t> OpenDirections(const Mesh& surface, const Mesh& points);

/// Share of the directions around `normal` that `open` leaves open, weighted by cosine: what
/// ambient light reaches a vertex.
float AmbientOpenness(std::uint64_t open, const Eigen::Vector3f& normal);

/// Share of the directions near `d` (within about 30°) that a vertex leaves open: soft shadow.
class OpennessTowards {
 public:
  explicit OpennessTowards(const Eigen::Vector3f& d);
  /// Of a vertex with the bits `open`.
  float Of(std::uint64_t open) const;

 private:
  struct Direction {
    int index;
    float weight;
  };
  std::vector<Direction> near_;
  float total_ = 1e-6f;
};

}  // namespace windhover
