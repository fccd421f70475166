#include "render/mesh_loader.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "common/geometry/rotation.h"
#include "render/aircraft_meshes.h"
#include "render/mesh_file.h"
#include "render/mesh_topology.h"

namespace windhover {
namespace {

constexpr float kMinSize_m = 1e-3f, kMaxSize_m = 1e3f;

[[noreturn]] void Fail(const InputFile& file, const std::string& what) {
  throw ConfigError(fmt::format("{}: {} (found '{}')", file.where, what, file.as_given));
}

Mesh Read(const InputFile& file) {
  try {
    return ReadMeshFile(file.absolute).mesh;
  } catch (const MeshFileError& error) {
    Fail(file, error.place.empty() ? std::string(error.what())
                                   : fmt::format("line {}: {}", error.place, error.what()));
  }
}

Eigen::Matrix3f Turn(const std::array<double, 3>& rotation_deg) {
  const auto about = [](const Eigen::Vector3d& axis, double deg) {
    return RotationFromVector(axis * RadFromDeg(deg));
  };
  return (about(Eigen::Vector3d::UnitZ(), rotation_deg[2]) *
          about(Eigen::Vector3d::UnitY(), rotation_deg[1]) *
          about(Eigen::Vector3d::UnitX(), rotation_deg[0]))
      .cast<float>();
}

// Into the body frame. Normals that a file got wrong are replaced by something harmless.
void Place(const MeshConfig& config, Mesh* mesh) {
  const Eigen::Matrix3f R = Turn(config.rotation_deg);
  const auto scale = static_cast<float>(config.scale);
  const Eigen::Vector3f offset =
      Eigen::Map<const Eigen::Vector3d>(config.offset_m.data()).cast<float>();
  for (Eigen::Vector3f& p : mesh->positions) {
    p = R * (p * scale) + offset;
    if (!p.allFinite()) Fail(config.file, "mesh has a vertex that is not finite");
  }
  for (Eigen::Vector3f& n : mesh->normals) {
    const float length = n.norm();
    n = std::isfinite(length) && length > 0 ? Eigen::Vector3f(R * (n / length))
                                            : Eigen::Vector3f::UnitZ();
  }
}

}  // namespace

Mesh LoadMesh(const MeshConfig& config) {
  Mesh mesh = Read(config.file);
  Place(config, &mesh);
  const float size_m = BoundingBox(mesh).diagonal().norm();
  if (size_m < kMinSize_m || size_m > kMaxSize_m) {
    Fail(
        config.file,
        fmt::format("mesh is {:.3g} m large; mesh.scale must bring it to 0.001 to 1000 m", size_m));
  }
  return mesh;
}

AircraftModel MakeAircraftModel(const Aircraft& aircraft) {
  switch (aircraft.type) {
    case AircraftType::kM200Orange:
      return MakeM200(/*orange=*/true);
    case AircraftType::kM200Black:
      return MakeM200(/*orange=*/false);
    case AircraftType::kP600:
      return MakeP600();
    case AircraftType::kMesh: {
      // Both sides of triangles are drawn unless the file's winding can be trusted.
      Mesh mesh = LoadMesh(aircraft.mesh);
      const bool is_closed = TurnOutwards(&mesh);
      return {
          .body = std::move(mesh), .rotor_discs = {}, .propellers = {}, .watertight = is_closed};
    }
  }
  throw std::logic_error("unknown aircraft type");
}

}  // namespace windhover
