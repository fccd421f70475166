#pragma once

#include "render/mesh.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Reads any file that assimp reads, with its node transforms, material colours and the mean
/// colours of its textures, and brings it into the body frame: y up becomes z up (glTF only),
/// then scale, then roll, pitch, yaw, then offset.
/// @throws ConfigError `where: …` if the file is missing, empty, broken, above 256 MiB or
/// 2 million triangles, or smaller than 1 mm or larger than 1 km after scaling.
Mesh LoadMesh(const MeshConfig& config);

}  // namespace windhover
