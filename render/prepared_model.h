#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
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
  /// Bits of render/mesh_visibility.h and what ambient light arrives, one a vertex of the body.
  std::vector<std::uint64_t> open_directions;
  std::vector<float> ambient_openness;
};

/// A model made ready for drawing: short edges for lens distortion, self-shading. Levels are made
/// when they are first asked for. Any thread may ask.
class PreparedModel {
 public:
  /// `radius_m`: of a ball about B's origin that holds the model.
  PreparedModel(AircraftModel model, double radius_m);

  /// The coarsest level whose edges appear no longer than 40 px from `depth_m` through a lens of
  /// `focal_px`, so that lines that the lens bends are off by at most 0.014 px at k1 = -0.25,
  /// k2 = 0.4 (docs/sources.md); the finest level if none is fine enough.
  const DetailLevel& LevelFor(double depth_m, double focal_px) const;

  const std::vector<Propeller>& Propellers() const { return model_.propellers; }
  bool IsWatertight() const { return model_.watertight; }

 private:
  static constexpr std::size_t kLevels = 5;  ///< Each halves the edges of the one before.
  float MaxEdge_m(std::size_t level) const;
  const DetailLevel& Level(std::size_t level) const;

  float size_m_;
  /// Coarse to fine; each begins with the vertices of the one before.
  mutable std::array<std::unique_ptr<const DetailLevel>, kLevels> levels_;
  mutable std::mutex making_level_;
  AircraftModel model_;
  double radius_m_;
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
