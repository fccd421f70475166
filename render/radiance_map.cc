#include "render/radiance_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/parallel_for.h"
#include "render/sphere_angles.h"

namespace windhover {
namespace {

constexpr int kTile = 64;
constexpr std::size_t kWindowMargin = 32;
constexpr int kWidthStep = 256;
constexpr double kTexelsPerPixel = 0.85;

int FloorDiv(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// Coordinates in which the chart's pole is z.
Eigen::Vector3d ToChart(const Eigen::Vector3d& d, Chart chart) {
  return chart == Chart::kUpright ? d : Eigen::Vector3d(d.z(), d.x(), d.y());
}
Eigen::Vector3d FromChart(const Eigen::Vector3d& d, Chart chart) {
  return chart == Chart::kUpright ? d : Eigen::Vector3d(d.y(), d.z(), d.x());
}

// From and to where whole tiles hold [min, max]. A tile more on either side stays if it was there:
// a view that trembles about a tile's edge does not fill its window over and over.
std::pair<int, int> WholeTiles(int min, int max, bool had_any, int old_min, int old_size) {
  const int from = FloorDiv(min, kTile) * kTile, to = (FloorDiv(max, kTile) + 1) * kTile;
  if (!had_any) return {from, to};
  return {std::clamp(old_min, from - kTile, from), std::clamp(old_min + old_size, to, to + kTile)};
}

std::uint16_t Encode(float light) {
  return static_cast<std::uint16_t>(std::fmin(std::fmax(light, 0.0f), 1.0f) * 32767 + 0.5f);
}

}  // namespace

void MapWindow::Resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  planes.resize(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height) +
                kWindowMargin);
}

void MapWindow::SetRow(int v, const Texel* texels) {
  std::uint16_t* plane = planes.data() + (Row(v) - planes.data());
  for (std::size_t c = 0; c < 3; ++c, plane += width) {
    for (int u = 0; u < width; ++u) plane[u] = texels[u][c];
  }
}

Chart ChartFor(const Eigen::Vector3d& d_W) {
  return std::abs(d_W.z()) < 0.77 ? Chart::kUpright : Chart::kLying;  // 50°
}

RadianceMap::RadianceMap(const Environment& environment, double focal_px)
    : environment_(environment),
      width_(kWidthStep * std::max(1, static_cast<int>(std::ceil(2 * EIGEN_PI * focal_px *
                                                                 kTexelsPerPixel / kWidthStep)))) {}

Eigen::Vector2d RadianceMap::PlaceOf(const Eigen::Vector3d& d_W, Chart chart) const {
  const Eigen::Vector3d d = ToChart(d_W, chart);
  return {-QuickAtan2(d.y(), d.x()) * TexelsPerRad(),
          QuickAtan2(std::sqrt(d.x() * d.x() + d.y() * d.y()), d.z()) * TexelsPerRad()};
}

std::vector<Eigen::Vector2d> RadianceMap::PlacesOf(const Eigen::Matrix3d& R_WC,
                                                   std::span<const Eigen::Vector3d> rays_C,
                                                   Chart chart) const {
  const std::size_t n = rays_C.size();
  std::vector<double> x(n), y(n), z(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d d = ToChart(R_WC * rays_C[i], chart);
    x[i] = d.x();
    y[i] = d.y();
    z[i] = d.z();
  }
  FindSphereAngles(n, x.data(), y.data(), z.data());
  std::vector<Eigen::Vector2d> places;
  places.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    places.emplace_back(-x[i] * TexelsPerRad(), y[i] * TexelsPerRad());
  }
  return places;
}

Eigen::Vector3d RadianceMap::DirectionAt(double u, double v, Chart chart) const {
  const double azimuth = -u / TexelsPerRad(), polar = v / TexelsPerRad();
  return FromChart(
      {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)},
      chart);
}

// One sample a texel: environments average over their footprint themselves.
std::vector<Texel> RadianceMap::ComputeTile(const TileKey& key) const {
  std::array<double, kTile> sin_azimuth, cos_azimuth;
  for (int u = 0; u < kTile; ++u) {
    const double azimuth = -(key.column * kTile + u) / TexelsPerRad();
    sin_azimuth[static_cast<std::size_t>(u)] = std::sin(azimuth);
    cos_azimuth[static_cast<std::size_t>(u)] = std::cos(azimuth);
  }
  std::vector<Eigen::Vector3f> directions, light(kTile * kTile);
  directions.reserve(kTile * kTile);
  for (int v = 0; v < kTile; ++v) {
    const double polar = (key.row * kTile + v) / TexelsPerRad();
    const double across = std::sin(polar), along = std::cos(polar);
    for (std::size_t u = 0; u < kTile; ++u) {
      directions.push_back(
          FromChart({across * cos_azimuth[u], across * sin_azimuth[u], along}, key.chart)
              .cast<float>());
    }
  }
  environment_.FillRadiance(directions, FootprintRad(), light);
  std::vector<Texel> texels;
  texels.reserve(light.size());
  for (const Eigen::Vector3f& rgb : light) {
    texels.push_back({Encode(rgb.x()), Encode(rgb.y()), Encode(rgb.z())});
  }
  return texels;
}

void RadianceMap::ComputeTiles(const std::vector<TileKey>& keys, int threads) {
  std::vector<Tile*> missing;
  std::vector<TileKey> missing_keys;
  for (const TileKey& key : keys) {
    const auto [entry, is_new] = tiles_.try_emplace(key);
    entry->second.used = covers_;
    if (!is_new) continue;
    missing.push_back(&entry->second);
    missing_keys.push_back(key);
  }
  ParallelFor(static_cast<int>(missing.size()), threads, [&](int i, int) {
    const auto k = static_cast<std::size_t>(i);
    missing[k]->texels = ComputeTile(missing_keys[k]);
  });
}

void RadianceMap::ForgetOldTiles() {
  if (tiles_.size() <= kMaxTiles) return;
  std::vector<std::pair<std::int64_t, TileKey>> by_age;
  for (const auto& [key, tile] : tiles_) by_age.emplace_back(tile.used, key);
  std::sort(by_age.begin(), by_age.end());
  by_age.resize(tiles_.size() - kMaxTiles);
  for (const auto& [used, key] : by_age) tiles_.erase(key);
}

std::vector<RadianceMap::TileKey> RadianceMap::TilesOf(const MapWindow& window) const {
  const int columns = width_ / kTile;
  std::vector<TileKey> keys;
  for (int v = window.v0; v < window.v0 + window.height; v += kTile) {
    for (int u = window.u0; u < window.u0 + window.width; u += kTile) {
      const int column = FloorDiv(u, kTile);
      keys.push_back({window.chart, column - FloorDiv(column + columns / 2, columns) * columns,
                      FloorDiv(v, kTile)});
    }
  }
  return keys;
}

void RadianceMap::Cover(Chart chart, int u_min, int u_max, int v_min, int v_max, int threads,
                        MapWindow* window) {
  if (!window->planes.empty() && window->chart == chart && u_min >= window->u0 &&
      u_max < window->u0 + window->width && v_min >= window->v0 &&
      v_max < window->v0 + window->height) {
    return;
  }
  ++covers_;
  const bool is_near = !window->planes.empty() && window->chart == chart;
  const auto [u0, u1] = WholeTiles(u_min, u_max, is_near, window->u0, window->width);
  const auto [v0, v1] = WholeTiles(v_min, v_max, is_near, window->v0, window->height);
  window->chart = chart;
  window->u0 = u0;
  window->v0 = v0;
  window->Resize(u1 - u0, v1 - v0);
  const std::vector<TileKey> keys = TilesOf(*window);
  ComputeTiles(keys, threads);
  std::vector<const Texel*> tiles;
  for (const TileKey& key : keys) tiles.push_back(tiles_.at(key).texels.data());
  const std::size_t n_columns = static_cast<std::size_t>(window->width / kTile);
  std::vector<Texel> row(static_cast<std::size_t>(window->width));
  for (int v = 0; v < window->height; ++v) {
    const Texel* const* tile = tiles.data() + static_cast<std::size_t>(v / kTile) * n_columns;
    for (int u = 0; u < window->width; u += kTile) {
      std::copy_n(*tile++ + v % kTile * kTile, kTile, row.data() + u);
    }
    window->SetRow(v, row.data());
  }
  ForgetOldTiles();
}

}  // namespace windhover
