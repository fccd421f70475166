#include "render/mesh_materials.h"

#include <algorithm>
#include <cmath>

#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/fields.h"
#include "common/image/image_codecs.h"
#include "common/image/image_header.h"
#include "render/mesh_builder.h"

namespace windhover {
namespace {

using Eigen::Vector3f;

// Textures are looked at a vertex at a time: finer ones would only alias.
constexpr int kTextureSize_px = 256;

// What is left of a metal's colour in matte light: it mirrors its surroundings, which are darker
// than the light that falls on it. Assumed.
constexpr float kMetalShare = 0.6f;

cv::Mat Decoded(const aiScene& scene, const std::string& name,
                const std::filesystem::path& folder) {
  cv::Mat image;
  try {
    if (const aiTexture* embedded = scene.GetEmbeddedTexture(name.c_str())) {
      const int n = static_cast<int>(embedded->mWidth);
      if (embedded->mHeight == 0) {
        CheckImageHeader({reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth});
        image = Codecs().imdecode(cv::Mat(1, n, CV_8U, embedded->pcData), cv::IMREAD_COLOR);
      } else {  // Blue, green, red, alpha.
        const cv::Mat raw(static_cast<int>(embedded->mHeight), n, CV_8UC4, embedded->pcData);
        cv::cvtColor(raw, image, cv::COLOR_BGRA2BGR);
      }
    } else {
      const std::filesystem::path file = folder / name;
      CheckImageFile(file);
      image = Codecs().imread(file.string(), cv::IMREAD_COLOR);
    }
  } catch (const cv::Exception& error) {
    throw MeshFileError(fmt::format("texture '{}' cannot be decoded: {}", name, error.err));
  } catch (const ConfigError& error) {
    throw MeshFileError(fmt::format("texture '{}': {}", name, error.what()));
  }
  if (image.empty()) throw MeshFileError(fmt::format("texture '{}' is no image", name));
  return image;
}

std::string TextureOf(const aiMaterial& material) {
  aiString name;
  if (material.GetTexture(aiTextureType_DIFFUSE, 0, &name) != AI_SUCCESS &&
      material.GetTexture(aiTextureType_BASE_COLOR, 0, &name) != AI_SUCCESS) {
    return "";
  }
  return name.C_Str();
}

Vector3f LinearFrom(const cv::Vec3b& bgr) { return ColourFromSrgb(bgr[2], bgr[1], bgr[0]); }

int Wrapped(float place, int n) {
  const float share = place - std::floor(place);
  return std::isfinite(share)
             ? std::clamp(static_cast<int>(share * static_cast<float>(n)), 0, n - 1)
             : 0;
}

}  // namespace

bool IsGltf(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".gltf" || extension == ".glb" || extension == ".GLTF" || extension == ".GLB";
}

MaterialSampler::MaterialSampler(const aiScene& scene, const aiMaterial& material,
                                 const std::filesystem::path& mesh_file)
    : is_linear_(IsGltf(mesh_file)) {
  aiColor4D c(0.6f, 0.6f, 0.6f, 1);
  if (material.Get(AI_MATKEY_BASE_COLOR, c) != AI_SUCCESS) material.Get(AI_MATKEY_COLOR_DIFFUSE, c);
  float metallic = 0;
  if (material.Get(AI_MATKEY_METALLIC_FACTOR, metallic) != AI_SUCCESS) metallic = 0;
  description_ = {.name = material.GetName().C_Str(),
                  .base_colour = Linear({c.r, c.g, c.b}),
                  .texture = TextureOf(material),
                  .metallic = std::isfinite(metallic) ? std::clamp(metallic, 0.0f, 1.0f) : 0};
  if (description_.texture.empty()) return;
  bgr_ = Decoded(scene, description_.texture, mesh_file.parent_path());
  const double shrink = static_cast<double>(kTextureSize_px) / std::max(bgr_.cols, bgr_.rows);
  if (shrink < 1) {
    cv::resize(bgr_, bgr_,
               {std::max(1, static_cast<int>(bgr_.cols * shrink)),
                std::max(1, static_cast<int>(bgr_.rows * shrink))},
               0, 0, cv::INTER_AREA);
  }
}

MeshMaterial MaterialSampler::Description() const {
  MeshMaterial description = description_;
  if (!bgr_.empty()) description.base_colour = MeanColour();
  return description;
}

Vector3f MaterialSampler::ColourAt(float u, float v) const {
  const Vector3f matte = description_.base_colour * (1 - (1 - kMetalShare) * description_.metallic);
  if (bgr_.empty()) return matte;
  const int x = Wrapped(u, bgr_.cols), y = bgr_.rows - 1 - Wrapped(v, bgr_.rows);
  return matte.cwiseProduct(LinearFrom(bgr_.at<cv::Vec3b>(y, x)));
}

Vector3f MaterialSampler::MeanColour() const {
  if (bgr_.empty()) return ColourAt(0, 0);
  Vector3f sum = Vector3f::Zero();
  for (int y = 0; y < bgr_.rows; ++y) {
    for (int x = 0; x < bgr_.cols; ++x) sum += LinearFrom(bgr_.at<cv::Vec3b>(y, x));
  }
  const Vector3f matte = description_.base_colour * (1 - (1 - kMetalShare) * description_.metallic);
  return matte.cwiseProduct(sum / static_cast<float>(bgr_.total()));
}

Vector3f MaterialSampler::Linear(const Vector3f& colour) const {
  const Vector3f c = colour.array().isFinite().select(colour, 0).cwiseMax(0).cwiseMin(1);
  if (is_linear_) return c;
  const auto byte = [](float v) { return static_cast<int>(v * 255); };
  return ColourFromSrgb(byte(c.x()), byte(c.y()), byte(c.z()));
}

}  // namespace windhover
