#include "render/mesh_loader.h"

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/geometry/rotation.h"
#include "render/aircraft_meshes.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{256} << 20;
constexpr std::size_t kMaxTriangles = 2'000'000;
constexpr float kMinSize_m = 1e-3f, kMaxSize_m = 1e3f;

[[noreturn]] void Fail(const InputFile& file, const std::string& what) {
  throw ConfigError(fmt::format("{}: {} (found '{}')", file.where, what, file.as_given));
}

const aiScene& Import(const InputFile& file, Assimp::Importer* importer) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file.absolute, error)) Fail(file, "no such mesh file");
  const std::uintmax_t bytes = std::filesystem::file_size(file.absolute, error);
  if (error || bytes == 0) Fail(file, "mesh file is empty or cannot be read");
  if (bytes > kMaxBytes) Fail(file, "mesh file is larger than 256 MiB");
  importer->SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer->SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40);
  importer->SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = nullptr;
  try {
    scene = importer->ReadFile(
        file.absolute, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                           aiProcess_JoinIdenticalVertices | aiProcess_FindDegenerates |
                           aiProcess_ValidateDataStructure);
  } catch (const std::exception& exception) {
    Fail(file, fmt::format("mesh cannot be read: {}", exception.what()));
  }
  if (scene == nullptr) {
    Fail(file, fmt::format("mesh cannot be read: {}", importer->GetErrorString()));
  }
  if (scene->mRootNode == nullptr || scene->mNumMeshes == 0) Fail(file, "has no triangles");
  return *scene;
}

Eigen::Vector3f MeanColour(const cv::Mat& bgr) {
  if (bgr.empty()) return Eigen::Vector3f::Ones();
  const cv::Scalar mean = cv::mean(bgr);
  return ColourFromSrgb(static_cast<int>(mean[2]), static_cast<int>(mean[1]),
                        static_cast<int>(mean[0]));
}

// Mean colour of a material's base-colour texture, white if there is none that can be read.
Eigen::Vector3f TextureColour(const aiScene& scene, const aiMaterial& material,
                              const std::filesystem::path& folder) {
  aiString name;
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != AI_SUCCESS &&
      material.GetTexture(aiTextureType_BASE_COLOR, 0, &name) != AI_SUCCESS) {
    return Eigen::Vector3f::Ones();
  }
  try {
    if (const aiTexture* embedded = scene.GetEmbeddedTexture(name.C_Str())) {
      if (embedded->mHeight != 0) return Eigen::Vector3f::Ones();
      const cv::Mat bytes(1, static_cast<int>(embedded->mWidth), CV_8U, embedded->pcData);
      return MeanColour(cv::imdecode(bytes, cv::IMREAD_COLOR));
    }
    return MeanColour(cv::imread((folder / name.C_Str()).string(), cv::IMREAD_COLOR));
  } catch (const cv::Exception&) {
    return Eigen::Vector3f::Ones();  // A mesh without its texture still shows its shape.
  }
}

// Material colours are linear in glTF and, by habit, sRGB in the older formats.
std::vector<Eigen::Vector3f> MaterialColours(const aiScene& scene,
                                             const std::filesystem::path& file) {
  const bool is_linear = file.extension() == ".gltf" || file.extension() == ".glb";
  std::vector<Eigen::Vector3f> colours;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    const aiMaterial& material = *scene.mMaterials[i];
    aiColor4D c(0.6f, 0.6f, 0.6f, 1);
    if (material.Get(AI_MATKEY_BASE_COLOR, c) != AI_SUCCESS) {
      material.Get(AI_MATKEY_COLOR_DIFFUSE, c);
    }
    const auto byte = [](float v) { return static_cast<int>(std::clamp(v, 0.0f, 1.0f) * 255); };
    const Eigen::Vector3f colour = is_linear
                                       ? Eigen::Vector3f(c.r, c.g, c.b).cwiseMax(0).cwiseMin(1)
                                       : ColourFromSrgb(byte(c.r), byte(c.g), byte(c.b));
    colours.push_back(colour.cwiseProduct(TextureColour(scene, material, file.parent_path())));
  }
  return colours;
}

void AppendNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent,
                const std::vector<Eigen::Vector3f>& colours, Mesh* mesh);

void AppendPart(const aiMesh& part, const aiMatrix4x4& X_node,
                const std::vector<Eigen::Vector3f>& colours, Mesh* out) {
  if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0 || !part.HasNormals()) return;
  const aiMatrix3x3 linear(X_node);
  const aiMatrix3x3 normal_matrix = aiMatrix3x3(linear).Inverse().Transpose();
  const bool mirrors = linear.Determinant() < 0;
  const auto base = static_cast<std::uint32_t>(out->positions.size());
  const Eigen::Vector3f colour = part.mMaterialIndex < colours.size()
                                     ? colours[part.mMaterialIndex]
                                     : Eigen::Vector3f::Constant(0.3f);
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D p = X_node * part.mVertices[i];
    const aiVector3D n = normal_matrix * part.mNormals[i];
    out->positions.emplace_back(p.x, p.y, p.z);
    out->normals.emplace_back(n.x, n.y, n.z);
    out->base_colours.push_back(colour);
  }
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const std::uint32_t a = base + face.mIndices[0], b = base + face.mIndices[1],
                        c = base + face.mIndices[2];
    out->triangles.push_back(mirrors ? std::array{a, c, b} : std::array{a, b, c});
  }
}

void AppendNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent,
                const std::vector<Eigen::Vector3f>& colours, Mesh* mesh) {
  if (mesh->triangles.size() > kMaxTriangles) return;
  const aiMatrix4x4 X_node = X_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    AppendPart(*scene.mMeshes[node.mMeshes[i]], X_node, colours, mesh);
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    AppendNode(scene, *node.mChildren[i], X_node, colours, mesh);
  }
}

// Turns y up, which glTF prescribes, into z up. Other formats keep the axes of the file; COLLADA's
// up_axis is ignored as Gazebo does, because files for robots are often wrong about it.
aiMatrix4x4 UpAxis(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  const bool is_y_up = extension == ".gltf" || extension == ".glb";
  return is_y_up ? aiMatrix4x4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1) : aiMatrix4x4();
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
  Assimp::Importer importer;
  const aiScene& scene = Import(config.file, &importer);
  Mesh mesh;
  AppendNode(scene, *scene.mRootNode, UpAxis(config.file.absolute),
             MaterialColours(scene, config.file.absolute), &mesh);
  if (mesh.triangles.empty()) Fail(config.file, "has no triangles");
  if (mesh.triangles.size() > kMaxTriangles) {
    Fail(config.file, "has more than 2 million triangles");
  }
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
    case AircraftType::kMesh:
      // A file's winding cannot be trusted, so both sides of its triangles are drawn.
      return {.body = LoadMesh(aircraft.mesh),
              .rotor_discs = {},
              .propellers = {},
              .watertight = false};
  }
  throw std::logic_error("unknown aircraft type");
}

}  // namespace windhover
