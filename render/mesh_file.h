#pragma once

#include <filesystem>
#include <string>

#include "render/mesh.h"
#include "render/mesh_checks.h"

namespace windhover {

struct MeshMaterial {
  std::string name;
  Eigen::Vector3f base_colour;  ///< Linear RGB.
  std::string texture;          ///< Of the base colour; empty: none.
  float metallic = 0;
};

/// What a mesh file holds.
struct MeshFile {
  Mesh mesh;  ///< In units of the file; z up, y before (UpAxis).
  std::vector<std::uint32_t> material_of_triangle;
  std::vector<MeshMaterial> materials;
  std::size_t degenerate = 0;  ///< Triangles without area, left out of the mesh.
};

/// Reads any format that assimp knows, in a process of its own (RunIsolated). glTF is turned from
/// y up, which it prescribes, to z up; other files keep their axes. A vertex has the colour of its
/// material times its own, times its texture there; metals are darker, as they have no matte
/// reflection of their own.
/// @throws MeshFileError: no such file, broken, nothing to draw, vertices that are not finite, no
/// texture where it says one is, more than 2 million triangles.
MeshFile ReadMeshFile(const std::filesystem::path& file);

}  // namespace windhover
