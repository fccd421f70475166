#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include <immintrin.h>

#include "render/warp_kernel.h"

namespace windhover {

// Inlined into the kernels of warp_kernel.cc, each compiled for its instruction set.

// Up to 16 pixels along a row, at one moment.
struct WarpSpan {
  std::int32_t u0, v0, u1, v1;

  std::int32_t U(int i) const { return u0 + (((u1 - u0) * i + 8) >> 4); }
  std::int32_t V(int i) const { return v0 + (((v1 - v0) * i + 8) >> 4); }
};

inline WarpSpan SpanAt(const WarpedRow& row, int x) {
  const int i = x / kWarpCell_px;
  return {row.u[i], row.v[i], row.u[i + 1], row.v[i + 1]};
}

// Pixels of the span at x.
inline int CountAt(const WarpedRow& row, int x) { return std::min(kWarpCell_px, row.width_px - x); }

constexpr int kPatches = 64;  // Spans that are prepared at once.

// Where the pixels of each span look: columns of pairs from `left` on, rows from `top` on.
struct WarpPatches {
  alignas(64) std::int32_t left[kPatches], columns[kPatches], top[kPatches], rows[kPatches];
};

// Places are in a straight line, so the ends bound them.
inline __attribute__((always_inline)) void FindPatches(const WarpedRow& row, int first,
                                                       WarpPatches* __restrict patches) {
  const auto last = [](std::int32_t from, std::int32_t to) {
    return from + (((to - from) * (kWarpCell_px - 1) + 8) >> 4);
  };
  const int n_spans = (row.width_px + kWarpCell_px - 1) / kWarpCell_px - first;
  const std::int32_t *u = row.u + first, *v = row.v + first;
  const int n = std::min(n_spans, kPatches);
  for (int i = 0; i < n; ++i) {
    const std::int32_t u_last = last(u[i], u[i + 1]), v_last = last(v[i], v[i + 1]);
    const std::int32_t left = (u[i] < u_last ? u[i] : u_last) >> 16;
    const std::int32_t top = (v[i] < v_last ? v[i] : v_last) >> 16;
    patches->left[i] = left;
    patches->columns[i] = ((u[i] < u_last ? u_last : u[i]) >> 16) - left + 1;
    patches->top[i] = top;
    patches->rows[i] = ((v[i] < v_last ? v_last : v[i]) >> 16) - top + 2;
  }
}

// Of the same spans at several moments.
using PatchesOfMoments = std::array<WarpPatches, kMaxWarpMoments>;

inline __attribute__((always_inline)) void FindPatches(std::span<const WarpedRow> moments,
                                                       int first, PatchesOfMoments* patches) {
  WarpPatches* next = patches->data();
  for (const WarpedRow& row : moments) FindPatches(row, first, next++);
}

struct WarpPatch {
  int column, row, n_rows;
  const std::uint16_t* texels;
};

constexpr int kMaxPatchRows = 6;

inline __attribute__((always_inline)) WarpPatch PatchAt(const MapWindow& window,
                                                        const WarpPatches& patches, int i) {
  return {patches.left[i], patches.top[i], patches.rows[i],
          window.Row(patches.top[i]) + patches.left[i]};
}

inline __attribute__((always_inline)) bool Serves(const WarpPatches& patches, int i,
                                                  int n_columns) {
  return patches.columns[i] <= n_columns && patches.rows[i] <= kMaxPatchRows;
}

inline __attribute__((always_inline)) bool Serve(const PatchesOfMoments& patches,
                                                 std::size_t n_moments, int i, int n_columns) {
  for (std::size_t m = 0; m < n_moments; ++m) {
    if (!Serves(patches[m], i, n_columns)) return false;
  }
  return true;
}

// The row below a patch is what the next rows of the image need; it is far away by then.
inline void Prefetch(const MapWindow& window, const WarpPatch& patch) {
  const std::uint16_t* below = patch.texels + std::ptrdiff_t{3} * patch.n_rows * window.width;
  for (int c = 0; c < 3; ++c, below += window.width) _mm_prefetch(below, _MM_HINT_T0);
}

}  // namespace windhover
