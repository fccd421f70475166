#include "render/key_frames.h"

#include <fmt/format.h>

namespace windhover {

bool KeyFrames::IsKept(int tick) const {
  for (int i = 0; i < kCount; ++i) {
    if (tick == (2 * i + 1) * n_ticks_ / (2 * kCount)) return true;
  }
  return false;
}

void KeyFrames::Keep(const RenderedPair& pair, int tick) const {
  if (dir_.empty() || !IsKept(tick)) return;
  std::filesystem::create_directories(dir_);
  const std::string name = fmt::format("{}_{}", pair.annotation.utime, pair.annotation.observer_id);
  WriteImage(pair.left, dir_ / (name + "_left.jpg"));
  WriteImage(pair.right, dir_ / (name + "_right.jpg"));
}

}  // namespace windhover
