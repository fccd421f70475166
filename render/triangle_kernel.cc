#include "render/triangle_kernel.h"

#include <algorithm>
#include <cstring>
#include <utility>

// Everything below is inlined into one function for each instruction set. Lanes never meet in
// arithmetic, and each operation is rounded as IEEE says, so that all give the same bits.
#define WINDHOVER_INLINE [[gnu::always_inline]] inline

namespace windhover {
namespace {

constexpr int kLanes = 8;
static_assert(SampleTile::kPadding >= kLanes);

using Float8 [[gnu::vector_size(32)]] = float;
using Int8 [[gnu::vector_size(32)]] = std::int32_t;
using Long8 [[gnu::vector_size(64)]] = std::int64_t;

template <typename Int>
struct LanesOf;
template <>
struct LanesOf<std::int32_t> {
  using Type = Int8;
};
template <>
struct LanesOf<std::int64_t> {
  using Type = Long8;
};

WINDHOVER_INLINE Float8 LoadFloats(const float* from) {
  Float8 lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

WINDHOVER_INLINE Int8 LoadInts(const std::uint32_t* from) {
  Int8 lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

WINDHOVER_INLINE Int8 Narrow(Int8 lanes) { return lanes; }
WINDHOVER_INLINE Int8 Narrow(Long8 lanes) { return __builtin_convertvector(lanes, Int8); }

struct Box {
  int first_column, last_column, first_row, last_row;
  bool IsEmpty() const { return first_column > last_column || first_row > last_row; }
};

struct Corners {
  const RasterVertex &a, &b, &c;
  std::int64_t area;  ///< Of FacingArea, positive.

  WINDHOVER_INLINE std::int32_t Left() const { return std::min({a.x, b.x, c.x}); }
  WINDHOVER_INLINE std::int32_t Right() const { return std::max({a.x, b.x, c.x}); }
  WINDHOVER_INLINE std::int32_t Top() const { return std::min({a.y, b.y, c.y}); }
  WINDHOVER_INLINE std::int32_t Bottom() const { return std::max({a.y, b.y, c.y}); }
};

WINDHOVER_INLINE Corners CornersOf(std::span<const RasterVertex> vertices,
                                   const RasterTriangle& triangle) {
  const RasterVertex &a = vertices[triangle.corners[0]], &b = vertices[triangle.corners[1]],
                     &c = vertices[triangle.corners[2]];
  return {a, b, c, FacingArea(a, b, c)};
}

// Samples of the tile, counted from its first, that the triangle's box holds; from a multiple of
// kLanes on, so that groups do not overlap what another triangle has just written.
WINDHOVER_INLINE Box BoxIn(const Corners& t, const SampleTile& tile) {
  return {std::max(FirstSampleAt(t.Left()) - tile.x0, 0) & -kLanes,
          std::min(LastSampleAt(t.Right()) - tile.x0, tile.width - 1),
          std::max(FirstSampleAt(t.Top()) - tile.y0, 0),
          std::min(LastSampleAt(t.Bottom()) - tile.y0, tile.height - 1)};
}

// Something affine in the image, from its values at the corners.
struct Plane {
  double first;  ///< At the first sample of the box.
  float per_column, per_row;
};

class PlaneSolver {
 public:
  WINDHOVER_INLINE PlaneSolver(const Corners& t, std::int64_t x_steps, std::int64_t y_steps) {
    const double per_area = kSampleSteps / static_cast<double>(t.area);
    xb_ = static_cast<double>(t.b.x - t.a.x) * per_area;
    yb_ = static_cast<double>(t.b.y - t.a.y) * per_area;
    xc_ = static_cast<double>(t.c.x - t.a.x) * per_area;
    yc_ = static_cast<double>(t.c.y - t.a.y) * per_area;
    columns_ = static_cast<double>(x_steps - t.a.x) / kSampleSteps;
    rows_ = static_cast<double>(y_steps - t.a.y) / kSampleSteps;
  }

  WINDHOVER_INLINE Plane Solve(float at_a, float at_b, float at_c) const {
    const double to_b = static_cast<double>(at_b) - static_cast<double>(at_a);
    const double to_c = static_cast<double>(at_c) - static_cast<double>(at_a);
    const double per_column = to_c * yb_ - to_b * yc_, per_row = to_b * xc_ - to_c * xb_;
    return {static_cast<double>(at_a) + per_column * columns_ + per_row * rows_,
            static_cast<float>(per_column), static_cast<float>(per_row)};
  }

  // The same of several values at once, in single precision.
  template <typename Values>
  WINDHOVER_INLINE void Solve(Values at_a, Values at_b, Values at_c, Values* first,
                              Values* per_column, Values* per_row) const {
    const Values to_b = at_b - at_a, to_c = at_c - at_a;
    *per_column = to_c * static_cast<float>(yb_) - to_b * static_cast<float>(yc_);
    *per_row = to_b * static_cast<float>(xc_) - to_c * static_cast<float>(xb_);
    *first =
        at_a + *per_column * static_cast<float>(columns_) + *per_row * static_cast<float>(rows_);
  }

 private:
  double xb_, yb_, xc_, yc_, columns_, rows_;
};

// E(x, y) = across (x - x_p) + down (y - y_p) of the edge from p to q: positive inside. Divided by
// kSampleSteps and rounded down it keeps its sign, as it changes by whole multiples from sample to
// sample.
template <typename Int>
struct Edge {
  WINDHOVER_INLINE Edge(const RasterVertex& p, const RasterVertex& q, std::int64_t x_steps,
                        std::int64_t y_steps)
      : across(q.y - p.y), down(p.x - q.x) {
    const bool owns_its_line = across > 0 || (across == 0 && down > 0);
    const std::int64_t value = std::int64_t{across} * (x_steps - p.x) +
                               std::int64_t{down} * (y_steps - p.y) - (owns_its_line ? 0 : 1);
    first = static_cast<Int>(value >> 8);
  }

  // Narrows the columns [*from, *to] of a row, counted from the box's first, to where the row may
  // be inside; `per_across` is 1 / across.
  WINDHOVER_INLINE void Limit(int row, int last_column, double per_across, int* from,
                              int* to) const {
    if (across == 0) return;
    const double at = -(static_cast<double>(first) + static_cast<double>(down) * row) * per_across;
    const int column = static_cast<int>(std::clamp(at, -2.0, last_column + 2.0));
    if (across > 0) {
      *from = std::max(*from, column - 1);
    } else {
      *to = std::min(*to, column + 1);
    }
  }

  std::int32_t across, down;
  Int first;  ///< At the first sample of the box.
};

// What ForRows needs of a triangle. `Int` holds E / kSampleSteps all over the box.
template <typename Int>
struct Slopes {
  using Lanes = typename LanesOf<Int>::Type;

  WINDHOVER_INLINE Slopes(const Corners& t, std::int64_t x_steps, std::int64_t y_steps)
      : edges{{t.a, t.b, x_steps, y_steps},
              {t.b, t.c, x_steps, y_steps},
              {t.c, t.a, x_steps, y_steps}} {
    const Plane plane =
        PlaneSolver(t, x_steps, y_steps).Solve(t.a.nearness, t.b.nearness, t.c.nearness);
    const Lanes lane = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int k = 0; k < 3; ++k) {
      e[k] = edges[k].first + lane * Int{edges[k].across};
      per_group[k] = Lanes{} + Int{edges[k].across} * Int{kLanes};
      per_row[k] = Lanes{} + Int{edges[k].down};
    }
    const Float8 float_lane = {0, 1, 2, 3, 4, 5, 6, 7};
    nearness = static_cast<float>(plane.first) + float_lane * plane.per_column;
    nearness_per_group = Float8{} + plane.per_column * float{kLanes};
    nearness_per_row = Float8{} + plane.per_row;
    lowest = Float8{} + std::min({t.a.nearness, t.b.nearness, t.c.nearness});
    highest = Float8{} + std::max({t.a.nearness, t.b.nearness, t.c.nearness});
  }

  // A sliver's slopes overshoot.
  WINDHOVER_INLINE Float8 Bounded(Float8 value) const {
    value = value < lowest ? lowest : value;
    return value > highest ? highest : value;
  }

  Edge<Int> edges[3];
  Lanes e[3], per_group[3], per_row[3];
  Float8 nearness, nearness_per_group, nearness_per_row, lowest, highest;
};

// Calls body(row, column, mask, nearness) for the groups of samples of a box one group wide.
template <typename Int, typename Body>
WINDHOVER_INLINE void ForRows(const Slopes<Int>& slopes, const Box& box, Body& body) {
  auto e0 = slopes.e[0], e1 = slopes.e[1], e2 = slopes.e[2];
  Float8 nearness = slopes.nearness;
  for (int row = box.first_row; row <= box.last_row; ++row) {
    body(row, box.first_column, Narrow((e0 | e1 | e2) >= 0), slopes.Bounded(nearness));
    e0 += slopes.per_row[0];
    e1 += slopes.per_row[1];
    e2 += slopes.per_row[2];
    nearness += slopes.nearness_per_row;
  }
}

// The same for wider boxes, and only for groups that may be inside.
template <typename Int, typename Body>
WINDHOVER_INLINE void ForWideRows(const Slopes<Int>& slopes, const Box& box, Body& body) {
  constexpr int kWide = 3 * kLanes;
  const int columns = box.last_column - box.first_column;
  double per_across[3];
  for (int k = 0; k < 3; ++k) per_across[k] = 1.0 / slopes.edges[k].across;
  for (int row = 0; row <= box.last_row - box.first_row; ++row) {
    int from = 0, to = columns;
    if (columns >= kWide) {
      for (int k = 0; k < 3; ++k) slopes.edges[k].Limit(row, columns, per_across[k], &from, &to);
      from &= -kLanes;
    }
    const Int group = from / kLanes;
    auto e0 = slopes.e[0] + slopes.per_row[0] * Int{row} + slopes.per_group[0] * group;
    auto e1 = slopes.e[1] + slopes.per_row[1] * Int{row} + slopes.per_group[1] * group;
    auto e2 = slopes.e[2] + slopes.per_row[2] * Int{row} + slopes.per_group[2] * group;
    Float8 nearness = slopes.nearness + slopes.nearness_per_row * static_cast<float>(row) +
                      slopes.nearness_per_group * static_cast<float>(group);
    for (int i = from; i <= to; i += kLanes) {
      body(box.first_row + row, box.first_column + i, Narrow((e0 | e1 | e2) >= 0),
           slopes.Bounded(nearness));
      e0 += slopes.per_group[0];
      e1 += slopes.per_group[1];
      e2 += slopes.per_group[2];
      nearness += slopes.nearness_per_group;
    }
  }
}

// Calls body as ForRows does for one triangle that the tile shows in part.
template <typename Body>
WINDHOVER_INLINE void DrawTriangle(const Corners& t, const Box& box, const SampleTile& tile,
                                   Body& body) {
  constexpr std::int32_t kMaxNarrow = 1024 * kSampleSteps;  // E / kSampleSteps is below 2^30.
  const std::int64_t x_steps =
      std::int64_t{tile.x0 + box.first_column} * kSampleSteps + kSampleSteps / 2;
  const std::int64_t y_steps =
      std::int64_t{tile.y0 + box.first_row} * kSampleSteps + kSampleSteps / 2;
  if (t.Right() - t.Left() > kMaxNarrow || t.Bottom() - t.Top() > kMaxNarrow) {
    ForWideRows(Slopes<std::int64_t>(t, x_steps, y_steps), box, body);
  } else if (box.last_column - box.first_column >= kLanes) {
    ForWideRows(Slopes<std::int32_t>(t, x_steps, y_steps), box, body);
  } else {
    ForRows(Slopes<std::int32_t>(t, x_steps, y_steps), box, body);
  }
}

WINDHOVER_INLINE void Opaque(std::span<const RasterVertex> vertices,
                             std::span<const RasterTriangle> triangles, const SampleTile tile) {
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const RasterTriangle& triangle = triangles[i];
    if (triangle.last_row < tile.y0 || triangle.first_row >= tile.y0 + tile.height) continue;
    const Corners corners = CornersOf(vertices, triangle);
    const Box box = BoxIn(corners, tile);
    if (box.IsEmpty()) continue;
    const Int8 index = Int8{} + static_cast<std::int32_t>(i + 1);
    auto keep_nearest = [&](int row, int column, Int8 inside, Float8 nearness) {
      const std::ptrdiff_t at = std::ptrdiff_t{row} * tile.stride + column;
      const Float8 before = LoadFloats(tile.nearness + at);
      const Int8 wins = inside & (nearness > before);
      const Float8 nearest = wins ? nearness : before;
      const Int8 indices = wins ? index : LoadInts(tile.nearest + at);
      std::memcpy(tile.nearness + at, &nearest, sizeof nearest);
      std::memcpy(tile.nearest + at, &indices, sizeof indices);
    };
    DrawTriangle(corners, box, tile, keep_nearest);
  }
}

using Float4 [[gnu::vector_size(16)]] = float;

WINDHOVER_INLINE Float4 LoadLight(const std::array<float, 4>& from) {
  Float4 light;
  std::memcpy(&light, from.data(), sizeof light);
  return light;
}

// Light and coverage over a triangle.
struct LightPlanes {
  WINDHOVER_INLINE LightPlanes(const Corners& t, const Box& box, const SampleTile& tile, Float4 a,
                               Float4 b, Float4 c) {
    const PlaneSolver solver(
        t, std::int64_t{tile.x0 + box.first_column} * kSampleSteps + kSampleSteps / 2,
        std::int64_t{tile.y0 + box.first_row} * kSampleSteps + kSampleSteps / 2);
    solver.Solve(a, b, c, &first, &per_column, &per_row);
    lowest = a < b ? a : b;
    lowest = lowest < c ? lowest : c;
    highest = a > b ? a : b;
    highest = highest > c ? highest : c;
  }

  Float4 first, per_column, per_row, lowest, highest;
};

WINDHOVER_INLINE void Blend(const LightPlanes& planes, float column, float row,
                            std::array<float, 4>* sample) {
  Float4 light = planes.first + column * planes.per_column + row * planes.per_row;
  light = light < planes.lowest ? planes.lowest : light;
  light = light > planes.highest ? planes.highest : light;
  Float4 below;
  std::memcpy(&below, sample, sizeof below);
  const Float4 above = light + below * (1.0f - light[3]);
  std::memcpy(sample, &above, sizeof above);
}

WINDHOVER_INLINE void Translucent(std::span<const RasterVertex> vertices,
                                  std::span<const std::array<float, 4>> light,
                                  std::span<const RasterTriangle> triangles, const SampleTile tile,
                                  const TranslucentTile out) {
  for (const RasterTriangle& triangle : triangles) {
    if (triangle.last_row < tile.y0 || triangle.first_row >= tile.y0 + tile.height) continue;
    const auto& t = triangle.corners;
    if (light[t[0]][3] + light[t[1]][3] + light[t[2]][3] <= 0) continue;
    const Corners corners = CornersOf(vertices, triangle);
    const Box box = BoxIn(corners, tile);
    if (box.IsEmpty()) continue;
    const LightPlanes planes(corners, box, tile, LoadLight(light[t[0]]), LoadLight(light[t[1]]),
                             LoadLight(light[t[2]]));
    auto blend = [&](int row, int column, Int8 inside, Float8 nearness) {
      const std::ptrdiff_t at = std::ptrdiff_t{row} * tile.stride + column;
      const Int8 shows = inside & (nearness > LoadFloats(tile.nearness + at));
      std::int32_t lanes[kLanes];
      std::memcpy(lanes, &shows, sizeof lanes);
      const int end = std::min(kLanes, tile.width - column);
      int first = end, last = 0;
      for (int i = 0; i < end; ++i) {
        if (lanes[i] == 0) continue;
        Blend(planes, static_cast<float>(column + i - box.first_column),
              static_cast<float>(row - box.first_row), out.light + at + i);
        first = std::min(first, i);
        last = i + 1;
      }
      if (last == 0) return;
      out.first[row] = std::min(out.first[row], column + first);
      out.last[row] = std::max(out.last[row], column + last);
    };
    DrawTriangle(corners, box, tile, blend);
  }
}

#define WINDHOVER_RASTER(isa, name)                                                        \
  __attribute__((target(isa), flatten)) void Opaque##name(                                 \
      std::span<const RasterVertex> vertices, std::span<const RasterTriangle> triangles,   \
      const SampleTile& tile) {                                                            \
    Opaque(vertices, triangles, tile);                                                     \
  }                                                                                        \
  __attribute__((target(isa), flatten)) void Translucent##name(                            \
      std::span<const RasterVertex> vertices, std::span<const std::array<float, 4>> light, \
      std::span<const RasterTriangle> triangles, const SampleTile& tile,                   \
      const TranslucentTile& out) {                                                        \
    Translucent(vertices, light, triangles, tile, out);                                    \
  }
WINDHOVER_RASTER("sse2", Sse2)
WINDHOVER_RASTER("avx2", Avx2)
WINDHOVER_RASTER("avx512f,avx512vl,avx512bw,avx512dq", Avx512)
#undef WINDHOVER_RASTER

}  // namespace

bool IsSupported(RasterIsa isa) {
  switch (isa) {
    case RasterIsa::kSse2:
      return true;
    case RasterIsa::kAvx2:
      return __builtin_cpu_supports("avx2") != 0;
    case RasterIsa::kAvx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
             __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0;
  }
  return false;
}

RasterIsa BestRasterIsa() {
  static const RasterIsa best = IsSupported(RasterIsa::kAvx512) ? RasterIsa::kAvx512
                                : IsSupported(RasterIsa::kAvx2) ? RasterIsa::kAvx2
                                                                : RasterIsa::kSse2;
  return best;
}

void DrawOpaque(RasterIsa isa, std::span<const RasterVertex> vertices,
                std::span<const RasterTriangle> triangles, const SampleTile& tile) {
  const auto draw = isa == RasterIsa::kAvx512 ? OpaqueAvx512
                    : isa == RasterIsa::kAvx2 ? OpaqueAvx2
                                              : OpaqueSse2;
  draw(vertices, triangles, tile);
}

void DrawTranslucent(RasterIsa isa, std::span<const RasterVertex> vertices,
                     std::span<const std::array<float, 4>> light,
                     std::span<const RasterTriangle> triangles, const SampleTile& tile,
                     const TranslucentTile& translucent) {
  const auto draw = isa == RasterIsa::kAvx512 ? TranslucentAvx512
                    : isa == RasterIsa::kAvx2 ? TranslucentAvx2
                                              : TranslucentSse2;
  draw(vertices, light, triangles, tile, translucent);
}

}  // namespace windhover
