#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "common/cpu/instruction_set.h"

namespace windhover {

/// Steps of a vertex's place between two samples.
inline constexpr int kSampleSteps = 256;

/// A vertex in the image: place in steps (sample i's centre is at i · kSampleSteps +
/// kSampleSteps / 2) and nearness, which is affine in the image: above 0, and greater where nearer.
struct RasterVertex {
  static constexpr std::int32_t kMaxPlace = 1 << 28;  ///< Of either sign.
  std::int32_t x, y;
  float nearness;
};

/// A triangle whose front faces the camera, and the rows of samples that it may cover.
struct RasterTriangle {
  std::array<std::uint32_t, 3> corners;
  std::int32_t first_row, last_row;
};

/// Twice the area in square steps of a triangle, positive if its front faces the camera: if its
/// corners go counter-clockwise where y points down.
inline std::int64_t FacingArea(const RasterVertex& a, const RasterVertex& b,
                               const RasterVertex& c) {
  return (std::int64_t{c.x} - a.x) * (std::int64_t{b.y} - a.y) -
         (std::int64_t{b.x} - a.x) * (std::int64_t{c.y} - a.y);
}

/// A rectangle of samples and what is seen in each so far. Rows hold `stride` samples, a multiple
/// of kPadding; one at least is beyond the last of the rectangle, and such may be overwritten.
struct SampleTile {
  static constexpr int kPadding = 8;
  int x0 = 0, y0 = 0, width = 0, height = 0, stride = 0;
  float* nearness = nullptr;         ///< Of what is nearest, 0 where nothing is.
  std::uint32_t* nearest = nullptr;  ///< Its triangle's index plus 1, 0 where nothing is.
};

/// Premultiplied light and coverage, 0 to 1, of what is translucent over a tile's samples.
struct TranslucentTile {
  std::array<float, 4>* light = nullptr;  ///< Rows as the tile's.
  /// Of each row, the columns [first, last) that something touched.
  int *first = nullptr, *last = nullptr;
};

/// The first sample whose centre is at or beyond `place` (in steps), and the last at or before it.
inline int FirstSampleAt(std::int32_t place) { return (place + kSampleSteps / 2 - 1) >> 8; }
inline int LastSampleAt(std::int32_t place) { return (place - kSampleSteps / 2) >> 8; }
static_assert(kSampleSteps == 256);

/// Draws triangles where they are nearer than what is there, which keeps its place in a tie.
/// Samples are inside by exact integers; of two triangles that share an edge, each sample on it
/// belongs to one.
///
/// Source: J. Pineda, "A Parallel Algorithm for Polygon Rasterization", SIGGRAPH 1988.
void DrawOpaque(InstructionSet isa, std::span<const RasterVertex> vertices,
                std::span<const RasterTriangle> triangles, const SampleTile& tile);

/// Blends translucent triangles, in order, over `translucent` where they are
/// nearer than what `tile` holds. `light`: premultiplied RGB and coverage, one a vertex, 0 to 1.
void DrawTranslucent(InstructionSet isa, std::span<const RasterVertex> vertices,
                     std::span<const std::array<float, 4>> light,
                     std::span<const RasterTriangle> triangles, const SampleTile& tile,
                     const TranslucentTile& translucent);

}  // namespace windhover
