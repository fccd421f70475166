#pragma once

#include "render/mesh.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Reads any file that assimp reads (ReadMeshFile) and brings it into the body frame: y up becomes
/// z up (glTF only), then scale, then roll, pitch, yaw, then offset.
/// @throws ConfigError `where: …` if ReadMeshFile fails, or if the mesh is smaller than 1 mm or
/// larger than 1 km after scaling.
Mesh LoadMesh(const MeshConfig& config);

}  // namespace windhover
