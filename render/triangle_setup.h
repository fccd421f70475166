#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "render/triangle_kernel.h"

// What render/triangle_kernel.cc works out of a triangle before it visits samples. All is inlined
// into one function for each instruction set. Lanes never meet in arithmetic, and each operation is
// rounded as IEEE says, so that all give the same bits.
#define WINDHOVER_INLINE [[gnu::always_inline]] inline

namespace windhover {

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

}  // namespace windhover
