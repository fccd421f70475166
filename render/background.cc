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

BackgroundWarp::BackgroundWarp(const RayGrid& grid, std::span<const WarpGrid> warps,
                               const RadianceMap& map, const MapWindow& window)
    : grid_(grid), warps_(warps), map_(map), window_(window) {
  if (warps.empty() || warps.size() > kMaxWarpMoments) {
    throw std::logic_error("BackgroundWarp: too many moments, or none");
  }
  std::uint32_t so_far = 0;
  for (const WarpGrid& warp : warps) {
    // What rounding takes from one moment it gives to the next.
    const std::uint32_t before = so_far * kWholeShare / 65536;
    so_far += warp.share;
    shares_.push_back(static_cast<std::int32_t>(so_far * kWholeShare / 65536 - before));
    Add(warp);
  }
}

void BackgroundWarp::Add(const WarpGrid& warp) {
  if (warp.u_min < window_.u0 || warp.u_max > window_.u0 + window_.width - 2 ||
      warp.v_min < window_.v0 || warp.v_max > window_.v0 + window_.height - 2) {
    throw std::logic_error("BackgroundWarp: the window does not cover the view");
  }
  near_pole_ = near_pole_ || warp.near_pole;
  for (const Eigen::Vector2d& place : warp.places) {
    u_.push_back(ToFixed(place.x() - window_.u0));
    v_.push_back(ToFixed(place.y() - window_.v0));
  }
}

void BackgroundWarp::Row(int y, std::uint16_t* rgb) const {
  if (near_pole_) {
    ExactRow(y, rgb);
    return;
  }
  const auto columns = static_cast<std::size_t>(grid_.columns), n = warps_.size();
  const int t = y % kRayCell_px;
  std::vector<std::int32_t> places(2 * n * columns);
  std::array<WarpedRow, kMaxWarpMoments> moments;
  for (std::size_t m = 0; m < n; ++m) {
    std::int32_t *u = places.data() + 2 * m * columns, *v = u + columns;
    const std::size_t above =
        (m * static_cast<std::size_t>(grid_.rows) + static_cast<std::size_t>(y / kRayCell_px)) *
        columns;
    FillBetween(u_.data() + above, u_.data() + above + columns, t, columns, u);
    FillBetween(v_.data() + above, v_.data() + above + columns, t, columns, v);
    moments[m] = {u, v, grid_.width_px, shares_[m]};
  }
  WarpMeanRow(window_, {moments.data(), n}, rgb);
}

// Between rows of nodes the camera turns evenly.
Eigen::Vector2d BackgroundWarp::ExactPlace(const WarpGrid& warp, int y,
                                           const Eigen::Vector3d& ray_C) const {
  const bool is_one = warp.R_WC.size() == 1;
  const auto j = static_cast<std::size_t>(is_one ? 0 : y / kRayCell_px);
  const double way = is_one ? 0 : y % kRayCell_px * (1.0 / kRayCell_px);
  Eigen::Matrix3d R_WC = warp.R_WC[j];
  if (way > 0) R_WC = (1 - way) * R_WC + way * warp.R_WC[j + 1];
  const Eigen::Vector3d d_W = R_WC * ray_C;
  Eigen::Vector2d place = map_.PlaceOf(d_W, warp.chart);
  const double u_near = (warp.u_min + warp.u_max) / 2;
  place.x() -= std::round((place.x() - u_near) / map_.Width()) * map_.Width();
  return place - Eigen::Vector2d(window_.u0, window_.v0);
}

void BackgroundWarp::ExactRow(int y, std::uint16_t* rgb) const {
  std::array<std::array<std::int32_t, 2>, kMaxWarpMoments> u{}, v{};
  std::array<WarpedRow, kMaxWarpMoments> moments;
  for (int x = 0; x < grid_.width_px; ++x) {
    const Eigen::Vector3d ray_C = RayOf(grid_.camera, {x, y});
    for (std::size_t m = 0; m < warps_.size(); ++m) {
      const Eigen::Vector2d place = ExactPlace(warps_[m], y, ray_C);
      u[m] = {ToFixed(place.x()), 0};
      v[m] = {ToFixed(place.y()), 0};
      moments[m] = {u[m].data(), v[m].data(), 1, shares_[m]};
    }
    WarpMeanRow(window_, {moments.data(), warps_.size()}, rgb + x * 3);
  }
}

}  // namespace windhover
