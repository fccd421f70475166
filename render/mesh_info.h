#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace windhover {

/// What a mesh file holds and how it would fare as an aircraft: triangles, size, units that it
/// seems to be in, winding, materials.
/// @throws ConfigError `FILE[:line]: …`, as ReadMeshFile.
nlohmann::ordered_json MeshInfo(const std::filesystem::path& file);

/// The same for people.
std::string MeshInfoText(const nlohmann::ordered_json& info);

}  // namespace windhover
