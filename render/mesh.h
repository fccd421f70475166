#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "render/propeller.h"

namespace windhover {

/// A coloured triangle mesh in the body frame B of an aircraft (forward-left-up, metres).
struct Mesh {
  std::vector<Eigen::Vector3f> positions;               ///< Vertices, m.
  std::vector<Eigen::Vector3f> normals;                 ///< Unit, outward; one a vertex.
  std::vector<Eigen::Vector3f> base_colours;            ///< Diffuse reflectance, linear RGB, 0..1.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Counter-clockwise from outside.
};

/// Appends `part` to `*mesh`.
void Append(const Mesh& part, Mesh* mesh);

/// The box around all vertices, m; empty for a mesh without vertices.
Eigen::AlignedBox3f BoundingBox(const Mesh& mesh);

/// The same surface with every edge at most `max_edge_m` long. Edges are halved, also where two
/// parts meet, so no gaps open. Stops at `max_triangles`.
Mesh WithShortEdges(Mesh mesh, float max_edge_m, std::size_t max_triangles = 400'000);

/// Indices of the vertices that are extreme in some direction, sorted: those which can bound
/// the silhouette. Found by 4,096 directions; a vertex left out lies within 0.1 % of the mesh's
/// size of the hull of those returned.
std::vector<std::uint32_t> ExtremeVertices(const std::vector<Eigen::Vector3f>& positions);

/// Unit vectors spread evenly over the sphere (Fibonacci lattice).
std::vector<Eigen::Vector3f> SphereDirections(int count);

/// What one type of aircraft looks like.
///
/// B's origin is the target's centre, to which every true distance refers: the centre of the
/// box around the aircraft with its propellers.
struct AircraftModel {
  Mesh body;
  Mesh rotor_discs;  ///< What turning propellers sweep, an equal share of its vertices each.
  std::vector<Propeller> propellers;  ///< In that order.
  bool watertight = true;             ///< Body parts are closed, so back faces can be left out.
};

}  // namespace windhover
