#include "render/triangle_kernel.h"

#include <algorithm>
#include <cstring>

#include "render/triangle_setup.h"

namespace windhover {
namespace {

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

void DrawOpaque(InstructionSet isa, std::span<const RasterVertex> vertices,
                std::span<const RasterTriangle> triangles, const SampleTile& tile) {
  const auto draw = isa == InstructionSet::kAvx512 ? OpaqueAvx512
                    : isa == InstructionSet::kAvx2 ? OpaqueAvx2
                                                   : OpaqueSse2;
  draw(vertices, triangles, tile);
}

void DrawTranslucent(InstructionSet isa, std::span<const RasterVertex> vertices,
                     std::span<const std::array<float, 4>> light,
                     std::span<const RasterTriangle> triangles, const SampleTile& tile,
                     const TranslucentTile& translucent) {
  const auto draw = isa == InstructionSet::kAvx512 ? TranslucentAvx512
                    : isa == InstructionSet::kAvx2 ? TranslucentAvx2
                                                   : TranslucentSse2;
  draw(vertices, light, triangles, tile, translucent);
}

}  // namespace windhover
