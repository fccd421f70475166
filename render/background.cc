#include "render/background.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace windhover {
namespace {

// The ray of a pixel, or of the nearest one towards the principal point that has a ray.
Eigen::Vector3d RayOf(const AnyCamera& camera, const Eigen::Vector2d& q_px) {
  const Intrinsics intrinsics = camera.intrinsics();
  const Eigen::Vector2d centre(intrinsics.cx_px, intrinsics.cy_px);
  for (double share = 1; share > 0.01; share -= 0.02) {
    if (const auto ray = camera.Unproject(centre + share * (q_px - centre))) return *ray;
  }
  return Eigen::Vector3d::UnitZ();
}

std::int32_t ToFixed(double texels) {
  return static_cast<std::int32_t>(std::floor(texels * 65536 + 0.5));
}

// Of the way from one row of nodes to the next, `t` of kRayCell_px rows.
__attribute__((target_clones("default", "avx2"))) void FillBetween(const std::int32_t* above,
                                                                   const std::int32_t* below, int t,
                                                                   std::size_t count,
                                                                   std::int32_t* nodes) {
  for (std::size_t i = 0; i < count; ++i) {
    nodes[i] = above[i] + ((below[i] - above[i]) * t + kRayCell_px / 2) / kRayCell_px;
  }
}

}  // namespace

RayGrid::RayGrid(const AnyCamera& lens, int width, int height)
    : width_px(width),
      height_px(height),
      columns((width + kRayCell_px - 1) / kRayCell_px + 1),
      rows((height + kRayCell_px - 1) / kRayCell_px + 1),
      camera(lens) {
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      rays_C.push_back(RayOf(camera, Eigen::Vector2d(i, j) * kRayCell_px));
    }
  }
}

WarpGrid MakeWarpGrid(const RayGrid& grid, const std::vector<Eigen::Matrix3d>& R_WC,
                      const RadianceMap& map, Chart chart, double u_near) {
  WarpGrid warp{.places = {},
                .u_min = 1e18,
                .u_max = -1e18,
                .v_min = 1e18,
                .v_max = -1e18,
                .near_pole = false,
                .R_WC = R_WC,
                .chart = chart};
  const std::span<const Eigen::Vector3d> rays_C = grid.rays_C;
  const std::size_t n_alike = rays_C.size() / R_WC.size();
  for (std::size_t row = 0; row < R_WC.size(); ++row) {
    const auto places = map.PlacesOf(R_WC[row], rays_C.subspan(row * n_alike, n_alike), chart);
    for (Eigen::Vector2d place : places) {
      place.x() -= std::round((place.x() - u_near) / map.Width()) * map.Width();
      warp.u_min = std::min(warp.u_min, place.x());
      warp.u_max = std::max(warp.u_max, place.x());
      warp.v_min = std::min(warp.v_min, place.y());
      warp.v_max = std::max(warp.v_max, place.y());
      warp.places.push_back(place);
    }
  }
  const double pole_margin = map.Width() / 36.0;  // 10°
  warp.near_pole = warp.v_min < pole_margin || warp.v_max > map.Width() / 2.0 - pole_margin;
  if (warp.near_pole) {  // The pole itself may be in view: all around it, up to it.
    warp.u_min = u_near - map.Width() / 2.0 - 1;
    warp.u_max = u_near + map.Width() / 2.0 + 1;
    (warp.v_min < pole_margin ? warp.v_min : warp.v_max) =
        warp.v_min < pole_margin ? 0 : map.Width() / 2.0;
  }
  return warp;
}

BackgroundWarp::BackgroundWarp(const RayGrid& grid, const WarpGrid& warp, const RadianceMap& map,
                               const MapWindow& window)
    : grid_(grid), warp_(warp), map_(map), window_(window) {
  if (warp.u_min < window.u0 || warp.u_max > window.u0 + window.width - 2 ||
      warp.v_min < window.v0 || warp.v_max > window.v0 + window.height - 2) {
    throw std::logic_error("BackgroundWarp: the window does not cover the view");
  }
  for (const Eigen::Vector2d& place : warp.places) {
    u_.push_back(ToFixed(place.x() - window.u0));
    v_.push_back(ToFixed(place.y() - window.v0));
  }
}

void BackgroundWarp::Row(int y, std::uint16_t* rgb) const {
  if (warp_.near_pole) {
    ExactRow(y, rgb);
    return;
  }
  const auto columns = static_cast<std::size_t>(grid_.columns);
  const std::size_t above = static_cast<std::size_t>(y / kRayCell_px) * columns;
  const int t = y % kRayCell_px;
  std::vector<std::int32_t> u(columns), v(columns);
  FillBetween(u_.data() + above, u_.data() + above + columns, t, columns, u.data());
  FillBetween(v_.data() + above, v_.data() + above + columns, t, columns, v.data());
  WarpRow(window_, {u.data(), v.data(), grid_.width_px}, rgb);
}

void BackgroundWarp::ExactRow(int y, std::uint16_t* rgb) const {
  // Between rows of nodes the camera turns evenly.
  const bool is_one = warp_.R_WC.size() == 1;
  const auto j = static_cast<std::size_t>(is_one ? 0 : y / kRayCell_px);
  const double way = is_one ? 0 : y % kRayCell_px * (1.0 / kRayCell_px);
  Eigen::Matrix3d R_WC = warp_.R_WC[j];
  if (way > 0) R_WC = (1 - way) * R_WC + way * warp_.R_WC[j + 1];
  for (int x = 0; x < grid_.width_px; ++x) {
    const Eigen::Vector3d d_W = R_WC * RayOf(grid_.camera, {x, y});
    Eigen::Vector2d place = map_.PlaceOf(d_W, warp_.chart);
    const double u_near = (warp_.u_min + warp_.u_max) / 2;
    place.x() -= std::round((place.x() - u_near) / map_.Width()) * map_.Width();
    const std::array u = {ToFixed(place.x() - window_.u0), 0};
    const std::array v = {ToFixed(place.y() - window_.v0), 0};
    WarpRow(window_, {u.data(), v.data(), 1}, rgb + x * 3);
  }
}

}  // namespace windhover
