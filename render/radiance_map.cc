#include "render/radiance_map.h"

#include <algorithm>
#include <cmath>

#include "render/parallel_for.h"

namespace windhover {
namespace {

constexpr int kTile = 128;
constexpr std::size_t kMaxTiles = 2048;  // 256 MiB.
constexpr double kTexelsPerPixel = 0.85;

int FloorDiv(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

// Coordinates in which the chart's pole is z.
Eigen::Vector3d ToChart(const Eigen::Vector3d& d, Chart chart) {
  return chart == Chart::kUpright ? d : Eigen::Vector3d(d.z(), d.x(), d.y());
}
Eigen::Vector3d FromChart(const Eigen::Vector3d& d, Chart chart) {
  return chart == Chart::kUpright ? d : Eigen::Vector3d(d.y(), d.z(), d.x());
}

std::uint16_t Encode(float light) {
  return static_cast<std::uint16_t>(std::fmin(std::fmax(light, 0.0f), 1.0f) * 65535 + 0.5f);
}

}  // namespace

Chart ChartFor(const Eigen::Vector3d& d_W) {
  return std::abs(d_W.z()) < 0.77 ? Chart::kUpright : Chart::kLying;  // 50°
}

RadianceMap::RadianceMap(const Environment& environment, double focal_px)
    : environment_(environment),
      width_(kTile * std::max(2, static_cast<int>(std::ceil(2 * EIGEN_PI * focal_px *
                                                            kTexelsPerPixel / kTile / 2)) *
                                     2)) {}

Eigen::Vector2d RadianceMap::PlaceOf(const Eigen::Vector3d& d_W, Chart chart) const {
  const Eigen::Vector3d d = ToChart(d_W, chart);
  return {-std::atan2(d.y(), d.x()) * TexelsPerRad(),
          std::atan2(std::hypot(d.x(), d.y()), d.z()) * TexelsPerRad()};
}

Eigen::Vector3d RadianceMap::DirectionAt(double u, double v, Chart chart) const {
  const double azimuth = -u / TexelsPerRad(), polar = v / TexelsPerRad();
  return FromChart(
      {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)},
      chart);
}

Texel RadianceMap::ComputeTexel(int u, int v, Chart chart) const {
  // Four samples a texel smooth the edges that a scene does not smooth itself.
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  const auto footprint_rad = static_cast<float>(0.7 / TexelsPerRad());
  for (const double dv : {-0.25, 0.25}) {
    for (const double du : {-0.25, 0.25}) {
      const Eigen::Vector3f d_W = DirectionAt(u + du, v + dv, chart).cast<float>();
      sum += environment_.Radiance(d_W, footprint_rad).cwiseMin(1);
    }
  }
  sum /= 4;
  return {Encode(sum.x()), Encode(sum.y()), Encode(sum.z()), 0};
}

RadianceMap::Tile RadianceMap::ComputeTile(const TileKey& key) const {
  Tile tile;
  tile.reserve(kTile * kTile);
  for (int v = 0; v < kTile; ++v) {
    for (int u = 0; u < kTile; ++u) {
      tile.push_back(ComputeTexel(key.column * kTile + u, key.row * kTile + v, key.chart));
    }
  }
  return tile;
}

void RadianceMap::ComputeTiles(const std::vector<TileKey>& keys, int threads) {
  std::vector<Tile*> missing;
  std::vector<TileKey> missing_keys;
  for (const TileKey& key : keys) {
    const auto [entry, is_new] = tiles_.try_emplace(key);
    if (!is_new) continue;
    missing.push_back(&entry->second);
    missing_keys.push_back(key);
  }
  ParallelFor(static_cast<int>(missing.size()), threads, [&](int i, int) {
    *missing[static_cast<std::size_t>(i)] = ComputeTile(missing_keys[static_cast<std::size_t>(i)]);
  });
}

void RadianceMap::CopyTile(const TileKey& key, int unwrapped_column, MapWindow* window) const {
  const Tile& tile = tiles_.at(key);
  const int u = unwrapped_column * kTile - window->u0, v = key.row * kTile - window->v0;
  for (int row = 0; row < kTile; ++row) {
    std::copy_n(tile.data() + row * kTile, kTile,
                window->texels.data() + static_cast<std::ptrdiff_t>(v + row) * window->width + u);
  }
}

void RadianceMap::Cover(Chart chart, int u_min, int u_max, int v_min, int v_max, int threads,
                        MapWindow* window) {
  if (!window->texels.empty() && window->chart == chart && u_min >= window->u0 &&
      u_max < window->u0 + window->width && v_min >= window->v0 &&
      v_max < window->v0 + window->height) {
    return;
  }
  constexpr int kMargin = kTile / 4;
  const int column0 = FloorDiv(u_min - kMargin, kTile), column1 = FloorDiv(u_max + kMargin, kTile);
  const int row0 = FloorDiv(v_min - kMargin, kTile), row1 = FloorDiv(v_max + kMargin, kTile);
  const int columns = width_ / kTile;
  if (tiles_.size() > kMaxTiles) tiles_.clear();
  std::vector<TileKey> keys;
  for (int row = row0; row <= row1; ++row) {
    for (int column = column0; column <= column1; ++column) {
      keys.push_back({chart, column - FloorDiv(column + columns / 2, columns) * columns, row});
    }
  }
  ComputeTiles(keys, threads);
  *window = {chart,
             column0 * kTile,
             row0 * kTile,
             (column1 - column0 + 1) * kTile,
             (row1 - row0 + 1) * kTile,
             {}};
  window->texels.resize(static_cast<std::size_t>(window->width) *
                        static_cast<std::size_t>(window->height));
  auto key = keys.begin();
  for (int row = row0; row <= row1; ++row) {
    for (int column = column0; column <= column1; ++column) CopyTile(*key++, column, window);
  }
}

}  // namespace windhover
