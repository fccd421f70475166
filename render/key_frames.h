#pragma once

#include <filesystem>

#include "render/stereo_renderer.h"

namespace windhover {

/// Keeps the images of a few ticks of a run as JPEG files for its report, spread evenly:
/// `<utime_us>_<observer>_<left|right>.jpg`.
class KeyFrames {
 public:
  static constexpr int kCount = 3;  ///< Ticks kept.

  /// `dir` is made when the first image is kept; empty: nothing is kept.
  KeyFrames(std::filesystem::path dir, int n_ticks) : dir_(std::move(dir)), n_ticks_(n_ticks) {}

  /// Writes both images of `pair` if `tick` is one that is kept.
  /// @throws std::runtime_error if they cannot be written.
  void Keep(const RenderedPair& pair, int tick) const;

 private:
  bool IsKept(int tick) const;

  std::filesystem::path dir_;
  int n_ticks_;
};

}  // namespace windhover
