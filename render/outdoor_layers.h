#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "render/daylight.h"

namespace windhover {

// What procedural outdoor scenes are made of. All lengths in metres; z is above the ground.

/// One look at a scene from `eye_height_m` above the origin of the ground.
struct SceneRay {
  Eigen::Vector3f d_W;  ///< Unit direction.
  float azimuth_rad;
  float slope;  ///< tan of the elevation.
  float footprint_rad;
  float eye_height_m;
  const Daylight* daylight;
  Eigen::Vector3f air;  ///< What the air far away looks like there.

  /// Height above the ground at horizontal distance `distance_m`.
  float HeightAt(float distance_m) const { return eye_height_m + distance_m * slope; }
  /// A surface that has `colour` at noon, at this hour and through the air.
  Eigen::Vector3f Lit(const Eigen::Vector3f& colour, float distance_m) const {
    return daylight->haze.Through(colour.cwiseProduct(daylight->surface_light), air, distance_m);
  }
};

/// What many rays from one eye may meet.
class SceneBounds {
 public:
  explicit SceneBounds(std::span<const SceneRay> rays);

  /// Whether a ray can be between heights `low_m` and `high_m` at `distance_m`.
  bool Reaches(float distance_m, float low_m, float high_m) const;
  /// Whether a ray can be within `reach_m` of azimuth `azimuth_deg`, across, at `distance_m`.
  bool LooksTo(float azimuth_deg, float distance_m, float reach_m) const;

 private:
  SceneRay lowest_, highest_;
  float middle_azimuth_rad_, half_width_rad_;
};

// Each layer says by `CanBeIn` whether `Draw` can add anything for any ray within bounds.

/// `over` in front of `*colour`, opaque for coverage 1.
inline void Blend(const Eigen::Vector3f& over, float coverage, Eigen::Vector3f* colour) {
  *colour += coverage * (over - *colour);
}

/// What a ray meets, the nearest first, so that nothing hidden need be looked at.
class Seen {
 public:
  void Add(const Eigen::Vector3f& colour, float coverage) {
    colour_ += clear_ * coverage * colour;
    clear_ *= 1 - coverage;
  }
  /// What is left to see is less than a third of a grey level in 8 bits, even next to black.
  bool IsEnough() const { return clear_ < 1e-4f; }
  const Eigen::Vector3f& colour() const { return colour_; }

 private:
  Eigen::Vector3f colour_ = Eigen::Vector3f::Zero();
  float clear_ = 1;
};

/// Sky with clouds and a sun.
Eigen::Vector3f SkyRadiance(const SceneRay& ray);

/// A ring of trees.
struct TreeRow {
  float distance_m, spacing_m, min_height_m, max_height_m;
  float trunk_share;  ///< Height of the lowest leaves over the tree's height.
  Eigen::Vector3f leaf_colour;
  std::uint32_t seed;
  bool CanBeIn(const SceneBounds& bounds) const;
  void Draw(const SceneRay& ray, Seen* seen) const;
};

/// A ring of buildings with windows.
struct BuildingRow {
  float distance_m, plot_m, min_height_m, max_height_m;
  float gap_share;  ///< Share of plots that are empty.
  std::uint32_t seed;
  bool CanBeIn(const SceneBounds& bounds) const;
  void Draw(const SceneRay& ray, Seen* seen) const;
};

/// A ring of fence: posts, a top rail and wire mesh.
struct Fence {
  float distance_m, height_m, post_spacing_m;
  Eigen::Vector3f wire_colour;
  bool CanBeIn(const SceneBounds& bounds) const;
  void Draw(const SceneRay& ray, Seen* seen) const;
};

/// Thin upright things at given places: floodlights, lamp posts.
struct Mast {
  float azimuth_deg, distance_m, height_m, radius_m;
  float head_width_m, head_height_m;  ///< A box on top.
  Eigen::Vector3f colour;
  float Reach_m() const { return std::max(head_width_m, 2 * radius_m); }
  bool CanBeIn(const SceneBounds& bounds) const;
  void Draw(const SceneRay& ray, Seen* seen) const;
};

/// A basketball hoop that faces the eye: backboard, square, ring, net and post.
struct Hoop {
  float azimuth_deg, distance_m;
  bool CanBeIn(const SceneBounds& bounds) const;
  void Draw(const SceneRay& ray, Seen* seen) const;
};

}  // namespace windhover
