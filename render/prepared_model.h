#pragma once

#include <cstdint>
#include <vector>

#include "render/environment.h"
#include "render/mesh.h"

namespace windhover {

/// A model at one fineness of its triangles.
struct DetailLevel {
  float max_edge_m;
  Mesh body;
  Eigen::AlignedBox3f box;  ///< Around body and discs.
  Mesh discs;  ///< Of the propellers; the same at each level, as their edges are short.
};

/// A model made ready for drawing: short edges for lens distortion, self-shading, outline.
class PreparedModel {
 public:
  /// `radius_m`: of a ball about B's origin that holds the model.
  PreparedModel(AircraftModel model, double radius_m);

  /// The coarsest level whose edges appear no longer than 40 px from `depth_m` through a lens of
  /// `focal_px`, so that lines that the lens bends are off by at most 0.014 px at k1 = -0.25,
  /// k2 = 0.4 (docs/sources.md); the finest level if none is fine enough.
  const DetailLevel& LevelFor(double depth_m, double focal_px) const;

  /// Bits of render/mesh_visibility.h of vertex `i` of the body, the same at each level.
  std::uint64_t OpenDirectionsOf(std::size_t i) const { return open_directions_[i]; }
  float AmbientOpennessOf(std::size_t i) const { return ambient_openness_[i]; }
  const std::vector<Propeller>& Propellers() const { return propellers_; }
  bool IsWatertight() const { return watertight_; }

 private:
  // Coarse to fine; each begins with the vertices of the one before.
  std::vector<DetailLevel> levels_;
  std::vector<std::uint64_t> open_directions_;  ///< One a vertex of the finest body.
  std::vector<float> ambient_openness_;
  double radius_m_;
  std::vector<Propeller> propellers_;
  bool watertight_;
};

/// A level with the light that its vertices reflect, linear RGB.
struct ShadedTarget {
  const PreparedModel* model;
  const DetailLevel* level;
  std::vector<Eigen::Vector3f> body_light, disc_light;
};

/// Lights a level in attitude `R_WB`: sun with soft self-shading, and the surroundings' light.
ShadedTarget Shade(const PreparedModel& model, const DetailLevel& level,
                   const Eigen::Matrix3d& R_WB, const SkyLight& light);

}  // namespace windhover
