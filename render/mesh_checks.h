#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace windhover {

/// What is wrong with a mesh file; `place` is line[:column], or empty where there are no lines.
struct MeshFileError : std::runtime_error {
  explicit MeshFileError(const std::string& what, std::string where = "")
      : std::runtime_error(what), place(std::move(where)) {}
  std::string place;
};

/// Checks what readers of meshes pass over or do not survive: size of the file, content of another
/// format than its name says, OBJ with vertices that are not finite or faces of vertices that are
/// not there, glTF whose nodes go in circles.
/// @throws MeshFileError
void CheckMeshFile(const std::filesystem::path& file);

}  // namespace windhover
