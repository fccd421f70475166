#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "render/environment.h"

namespace windhover {

/// Which way an equirectangular map of the surroundings lies: its pole is W's up axis, or W's
/// north axis for cameras that look steeply up or down.
enum class Chart { kUpright, kLying };

/// The chart whose pole is far from the direction `d_W`.
Chart ChartFor(const Eigen::Vector3d& d_W);

/// Red, green and blue; 32767 is white, linear.
using Texel = std::array<std::uint16_t, 3>;

/// A rectangle of a map's texels, as interpolation wants them.
struct MapWindow {
  Chart chart = Chart::kUpright;
  int u0 = 0, v0 = 0;         ///< Map coordinates of its first texel; u0 is not wrapped.
  int width = 0, height = 0;  ///< Texels.
  /// Rows from the top, in each row three planes of `width` values: red, green, blue. Some more
  /// values follow, for vectors that begin at the last texels.
  std::vector<std::uint16_t> planes;

  void Resize(int new_width, int new_height);
  /// Sets row `v` of `width` texels.
  void SetRow(int v, const Texel* texels);
  const std::uint16_t* Row(int v) const {
    return planes.data() + static_cast<std::size_t>(v) * static_cast<std::size_t>(3 * width);
  }
  Texel At(int u, int v) const {
    const std::uint16_t* red = Row(v) + u;
    return {red[0], red[width], red[2 * width]};
  }
};

/// An equirectangular map of an environment at the resolution of a lens, computed tile by tile
/// where cameras look. A texel is a function of its place alone, so any order of use gives the
/// same map.
class RadianceMap {
 public:
  static constexpr std::size_t kMaxTiles = 1536;  ///< 36 MiB.

  /// `focal_px`: of the lens, its pixels per radian. The map has up to 0.9 texels a pixel, so
  /// that linear interpolation between texels does not alias.
  RadianceMap(const Environment& environment, double focal_px);

  int Width() const { return width_; }
  std::size_t TileCount() const { return tiles_.size(); }
  double TexelsPerRad() const { return width_ / (2 * EIGEN_PI); }
  /// What one texel averages over: a little more than its own width, so that edges are smooth.
  float FootprintRad() const { return static_cast<float>(1.1 / TexelsPerRad()); }

  /// Where the map shows direction `d_W`: u in [-Width/2, Width/2], v from 0 (the pole) to
  /// Width/2; whole numbers are texel centres.
  Eigen::Vector2d PlaceOf(const Eigen::Vector3d& d_W, Chart chart) const;
  /// The same for many rays of a camera that is turned by `R_WC`.
  std::vector<Eigen::Vector2d> PlacesOf(const Eigen::Matrix3d& R_WC,
                                        std::span<const Eigen::Vector3d> rays_C, Chart chart) const;
  /// The direction shown at (u, v).
  Eigen::Vector3d DirectionAt(double u, double v, Chart chart) const;

  /// Makes `*window` hold all texels of [u_min, u_max] × [v_min, v_max], and some around; does
  /// nothing if it already does. Computes missing tiles on `threads` threads, and forgets those
  /// that were not asked for the longest beyond kMaxTiles.
  void Cover(Chart chart, int u_min, int u_max, int v_min, int v_max, int threads,
             MapWindow* window);

 private:
  struct TileKey {
    Chart chart;
    int column, row;
    auto operator<=>(const TileKey&) const = default;
  };
  struct Tile {
    std::vector<Texel> texels;
    std::int64_t used = 0;  ///< The last Cover that wanted it.
  };

  /// The tiles of `window`, which begins and ends with whole ones, row by row.
  std::vector<TileKey> TilesOf(const MapWindow& window) const;
  void ComputeTiles(const std::vector<TileKey>& keys, int threads);
  std::vector<Texel> ComputeTile(const TileKey& key) const;
  void ForgetOldTiles();

  const Environment& environment_;
  int width_;
  std::int64_t covers_ = 0;
  std::map<TileKey, Tile> tiles_;
};

}  // namespace windhover
