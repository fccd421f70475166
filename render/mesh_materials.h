#pragma once

#include <filesystem>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "render/mesh_file.h"

struct aiMaterial;
struct aiScene;

namespace windhover {

bool IsGltf(const std::filesystem::path& file);

/// A material of a scene that assimp has read, as the colour of a matte surface.
class MaterialSampler {
 public:
  /// @throws MeshFileError if its texture is missing or cannot be decoded.
  MaterialSampler(const aiScene& scene, const aiMaterial& material,
                  const std::filesystem::path& mesh_file);

  MeshMaterial Description() const;
  /// Linear RGB at a place of the texture, (0, 0) its bottom left corner; repeats outside.
  Eigen::Vector3f ColourAt(float u, float v) const;
  Eigen::Vector3f MeanColour() const;
  /// Colours are linear in glTF and, by habit, sRGB in older formats.
  Eigen::Vector3f Linear(const Eigen::Vector3f& colour) const;

 private:
  bool is_linear_;
  MeshMaterial description_;
  cv::Mat bgr_;  ///< At most 256 px wide and high; empty: no texture.
};

}  // namespace windhover
