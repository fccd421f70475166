#pragma once

#include <cstddef>

#include "render/mesh.h"

namespace windhover {

/// How the triangles of a mesh hang together; vertices at the same place count as one.
struct MeshTopology {
  std::size_t vertices = 0;         ///< Places.
  std::size_t parts = 0;            ///< Connected.
  std::size_t inverted = 0;         ///< Parts that are closed, but wound clockwise from outside.
  std::size_t open_edges = 0;       ///< With one triangle.
  std::size_t turned_edges = 0;     ///< Between two triangles of opposite winding.
  std::size_t branching_edges = 0;  ///< Between more than two triangles.

  bool IsConsistent() const { return turned_edges == 0; }
  bool IsWatertight() const { return open_edges == 0 && turned_edges == 0 && branching_edges == 0; }
  /// Back faces can be left out.
  bool IsClosedOutward() const { return IsWatertight() && inverted == 0; }
};

MeshTopology TopologyOf(const Mesh& mesh);

/// Turns a watertight mesh whose parts all face inwards inside out, normals too where they do.
/// @return whether back faces of the mesh can now be left out.
bool TurnOutwards(Mesh* mesh);

}  // namespace windhover
