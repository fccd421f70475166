#include "render/key_frames.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

RenderedPair PairAt(Utime utime) {
  RenderedPair pair{};
  pair.left = pair.right = RgbImage(16, 8);
  pair.annotation.utime = utime;
  pair.annotation.observer_id = 4;
  return pair;
}

std::set<std::string> Kept(const std::filesystem::path& folder, int n_ticks) {
  const KeyFrames frames(folder, n_ticks);
  for (int tick = -1; tick < n_ticks; ++tick) frames.Keep(PairAt(1000 * tick), tick);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.insert(entry.path().filename());
  }
  return names;
}

// Twelve ticks in three equal parts have their middles at 2, 6 and 10.
TEST(KeyFrames, AreSpreadEvenly) {
  const TemporaryFolder folder;
  EXPECT_THAT(Kept(folder.path() / "frames", 12),
              testing::ElementsAre("10000_4_left.jpg", "10000_4_right.jpg", "2000_4_left.jpg",
                                   "2000_4_right.jpg", "6000_4_left.jpg", "6000_4_right.jpg"));
}

TEST(KeyFrames, OfARunOfOneTickIsThatTick) {
  const TemporaryFolder folder;
  EXPECT_THAT(Kept(folder.path() / "frames", 1),
              testing::ElementsAre("0_4_left.jpg", "0_4_right.jpg"));
}

TEST(KeyFrames, WithoutAFolderKeepsNothing) {
  const KeyFrames frames("", 3);
  EXPECT_NO_THROW(frames.Keep(PairAt(1000), 1));
}

}  // namespace
}  // namespace windhover
