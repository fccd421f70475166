#include "render/mesh_file.h"

#include <cmath>
#include <cstring>
#include <type_traits>

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "common/image/image_codecs.h"
#include "common/process/isolated.h"
#include "render/mesh_builder.h"
#include "render/mesh_materials.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

constexpr std::size_t kMaxTriangles = 2'000'000;

const aiScene& Import(const std::filesystem::path& file, Assimp::Importer* importer) {
  importer->SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE,
                               aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer->SetPropertyFloat(AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40);
  importer->SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer->ReadFile(
      file, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_GenSmoothNormals |
                aiProcess_JoinIdenticalVertices | aiProcess_ValidateDataStructure);
  if (scene == nullptr) {
    throw MeshFileError(fmt::format("mesh cannot be read: {}", importer->GetErrorString()));
  }
  if (scene->mRootNode == nullptr || scene->mNumMeshes == 0) {
    throw MeshFileError("has no triangles");
  }
  return *scene;
}

// Turns y up, which glTF prescribes, into z up. Other formats keep the axes of the file; COLLADA's
// up_axis is ignored as Gazebo does, because files for robots are often wrong about it.
aiMatrix4x4 UpAxis(const std::filesystem::path& file) {
  return IsGltf(file) ? aiMatrix4x4(1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1)
                      : aiMatrix4x4();
}

Vector3f ColourOfVertex(const aiMesh& part, unsigned i, const MaterialSampler& material) {
  const aiVector3D* place = part.HasTextureCoords(0) ? &part.mTextureCoords[0][i] : nullptr;
  Vector3f colour =
      place == nullptr ? material.MeanColour() : material.ColourAt(place->x, place->y);
  if (part.HasVertexColors(0)) {
    const aiColor4D& c = part.mColors[0][i];
    colour = colour.cwiseProduct(material.Linear({c.r, c.g, c.b}));
  }
  return colour;
}

bool HasArea(const Mesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vector3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  return (b - a).cast<double>().cross((c - a).cast<double>()).squaredNorm() > 0;
}

void AppendTriangles(const aiMesh& part, std::uint32_t base, bool mirrors, MeshFile* out) {
  for (unsigned i = 0; i < part.mNumFaces; ++i) {
    const aiFace& face = part.mFaces[i];
    if (face.mNumIndices != 3) continue;
    const std::uint32_t a = base + face.mIndices[0], b = base + face.mIndices[1],
                        c = base + face.mIndices[2];
    const auto triangle = mirrors ? std::array{a, c, b} : std::array{a, b, c};
    if (!HasArea(out->mesh, triangle)) {
      ++out->degenerate;
      continue;
    }
    out->mesh.triangles.push_back(triangle);
    out->material_of_triangle.push_back(part.mMaterialIndex);
  }
}

void AppendPart(const aiMesh& part, const aiMatrix4x4& X_node,
                const std::vector<MaterialSampler>& materials, MeshFile* out) {
  if ((part.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0 || !part.HasNormals()) return;
  const aiMatrix3x3 linear(X_node);
  const aiMatrix3x3 normal_matrix = aiMatrix3x3(linear).Inverse().Transpose();
  const auto base = static_cast<std::uint32_t>(out->mesh.positions.size());
  for (unsigned i = 0; i < part.mNumVertices; ++i) {
    const aiVector3D p = X_node * part.mVertices[i];
    const aiVector3D n = normal_matrix * part.mNormals[i];
    out->mesh.positions.emplace_back(p.x, p.y, p.z);
    if (!out->mesh.positions.back().allFinite()) {
      throw MeshFileError("mesh has a vertex that is not finite");
    }
    out->mesh.normals.emplace_back(n.x, n.y, n.z);
    out->mesh.base_colours.push_back(ColourOfVertex(part, i, materials.at(part.mMaterialIndex)));
  }
  AppendTriangles(part, base, linear.Determinant() < 0, out);
}

void AppendNode(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent,
                const std::vector<MaterialSampler>& materials, MeshFile* out) {
  const aiMatrix4x4 X_node = X_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    AppendPart(*scene.mMeshes[node.mMeshes[i]], X_node, materials, out);
    if (out->mesh.triangles.size() > kMaxTriangles) {
      throw MeshFileError("has more than 2 million triangles");
    }
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    AppendNode(scene, *node.mChildren[i], X_node, materials, out);
  }
}

MeshFile ReadHere(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene& scene = Import(file, &importer);
  MeshFile out;
  std::vector<MaterialSampler> samplers;
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) {
    samplers.emplace_back(scene, *scene.mMaterials[i], file);
    out.materials.push_back(samplers.back().Description());
  }
  AppendNode(scene, *scene.mRootNode, UpAxis(file), samplers, &out);
  if (out.mesh.triangles.empty()) throw MeshFileError("has no triangles");
  return out;
}

// --- Through the pipe from the isolated process --------------------------------------------------

template <typename Value>
void Put(const std::vector<Value>& values, std::string* bytes) {
  const std::uint64_t n = values.size();
  bytes->append(reinterpret_cast<const char*>(&n), sizeof n);
  bytes->append(reinterpret_cast<const char*>(values.data()), n * sizeof(Value));
}

template <typename Value>
void Get(const std::string& bytes, std::size_t* at, std::vector<Value>* values) {
  std::uint64_t n = 0;
  if (bytes.size() - *at < sizeof n) throw MeshFileError("the reader ended early");
  std::memcpy(&n, bytes.data() + *at, sizeof n);
  *at += sizeof n;
  if (n > (bytes.size() - *at) / sizeof(Value)) throw MeshFileError("the reader ended early");
  values->resize(n);
  if (n > 0) std::memcpy(static_cast<void*>(values->data()), bytes.data() + *at, n * sizeof(Value));
  *at += n * sizeof(Value);
}

template <typename File, typename Part>
void ForEachPart(File& file, const Part& part) {
  part(file.mesh.positions);
  part(file.mesh.normals);
  part(file.mesh.base_colours);
  part(file.mesh.triangles);
  part(file.material_of_triangle);
}

std::string BytesFrom(const MeshFile& file) {
  nlohmann::json materials = nlohmann::json::array();
  for (const MeshMaterial& m : file.materials) {
    const Vector3f& c = m.base_colour;
    materials.push_back({m.name, {c.x(), c.y(), c.z()}, m.texture, m.metallic});
  }
  const std::string text = nlohmann::json::array({materials, file.degenerate})
                               .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string bytes;
  Put(std::vector<char>(text.begin(), text.end()), &bytes);
  ForEachPart(file, [&](const auto& values) { Put(values, &bytes); });
  return bytes;
}

MeshFile FileFrom(const std::string& bytes) {
  MeshFile file;
  std::size_t at = 0;
  std::vector<char> text;
  Get(bytes, &at, &text);
  const nlohmann::json json = nlohmann::json::parse(text.begin(), text.end());
  for (const nlohmann::json& m : json[0]) {
    const auto c = m[1].get<std::array<float, 3>>();
    file.materials.push_back({.name = m[0].get<std::string>(),
                              .base_colour = Vector3f(c[0], c[1], c[2]),
                              .texture = m[2].get<std::string>(),
                              .metallic = m[3].get<float>()});
  }
  file.degenerate = json[1].get<std::size_t>();
  ForEachPart(file, [&](auto& values) { Get(bytes, &at, &values); });
  return file;
}

}  // namespace

MeshFile ReadMeshFile(const std::filesystem::path& file) {
  CheckMeshFile(file);
  Codecs();
  try {
    return FileFrom(
        RunIsolated(std::filesystem::file_size(file), [&] { return BytesFrom(ReadHere(file)); }));
  } catch (const ConfigError& error) {
    throw MeshFileError(error.what());
  }
}

}  // namespace windhover
