#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "camera/any_camera.h"
#include "render/radiance_map.h"
#include "render/warp_kernel.h"

namespace windhover {

/// Spacing of the grid on which rays are exact, px.
inline constexpr int kRayCell_px = kWarpCell_px;

/// The rays of one camera on a grid of its pixels, in C. They depend on the lens alone.
class RayGrid {
 public:
  RayGrid(const AnyCamera& camera, int width_px, int height_px);

  int width_px, height_px;
  int columns, rows;  ///< Of nodes: pixel (16 i, 16 j), beyond the last pixel.
  AnyCamera camera;
  std::vector<Eigen::Vector3d> rays_C;  ///< Unit, row by row.
};

/// Where each node of a RayGrid looks in a RadianceMap, for one orientation of the camera.
struct WarpGrid {
  std::vector<Eigen::Vector2d> places;  ///< Map coordinates; u is continuous across the map's seam.
  double u_min, u_max, v_min, v_max;    ///< Of all places.
  bool near_pole;                       ///< So near that interpolating places is not allowed.
  std::vector<Eigen::Matrix3d> R_WC;    ///< Of each row of nodes, or one for all.
  Chart chart;
  std::uint32_t share = 65536;  ///< Of the mean over the exposure, in 65536ths.
};

/// `R_WC`: one orientation, or one for each row of the grid's nodes (a rolling shutter).
/// `u_near`: the turn of u that places are next to, so that cameras side by side share a window.
WarpGrid MakeWarpGrid(const RayGrid& grid, const std::vector<Eigen::Matrix3d>& R_WC,
                      const RadianceMap& map, Chart chart, double u_near);

/// Draws the surroundings as a camera sees them, row by row.
class BackgroundWarp {
 public:
  /// `warps`: 1 to kMaxWarpMoments moments of an exposure, of which rows are the weighted mean;
  /// their shares sum to 1. `window` must cover the places of all; all must outlive this.
  BackgroundWarp(const RayGrid& grid, std::span<const WarpGrid> warps, const RadianceMap& map,
                 const MapWindow& window);

  /// Writes the linear light of row `y`: 3 · width values, and up to kRowMargin more.
  void Row(int y, std::uint16_t* rgb) const;

 private:
  void Add(const WarpGrid& warp);
  void ExactRow(int y, std::uint16_t* rgb) const;
  Eigen::Vector2d ExactPlace(const WarpGrid& warp, int y, const Eigen::Vector3d& ray_C) const;

  const RayGrid& grid_;
  const std::span<const WarpGrid> warps_;
  const RadianceMap& map_;
  const MapWindow& window_;
  bool near_pole_ = false;
  std::vector<std::int32_t> shares_;  ///< Of kWholeShare.
  std::vector<std::int32_t> u_, v_;   ///< Places of the nodes in the window, 1/65536 texels.
};

}  // namespace windhover
