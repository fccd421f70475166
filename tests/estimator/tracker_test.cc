#include "estimator/tracker.h"

#include <cmath>

#include <gtest/gtest.h>

namespace windhover {
namespace {

Tracker::Sighting At(double azimuth_rad) {
  return {{std::cos(azimuth_rad), std::sin(azimuth_rad), 0}, /*width_rad=*/0.01};
}

using Ids = std::vector<int>;

TEST(Tracker, NumbersTargetsInOrderOfAppearance) {
  Tracker tracker;
  EXPECT_EQ(tracker.Assign(0, {At(0), At(0.5)}), (Ids{0, 1}));
  EXPECT_EQ(tracker.Assign(100'000, {At(0.5), At(1), At(0)}), (Ids{1, 2, 0}));
}

TEST(Tracker, FollowsATargetThatMoves) {
  Tracker tracker;
  tracker.Assign(0, {At(0)});
  for (int k = 1; k < 50; ++k) EXPECT_EQ(tracker.Assign(k * 50'000, {At(0.03 * k)}), Ids{0});
}

TEST(Tracker, JumpsAreNewTargets) {
  Tracker tracker;
  tracker.Assign(0, {At(0)});
  EXPECT_EQ(tracker.Assign(50'000, {At(0.06)}), Ids{1});  // Beyond 2 · 0.01 + 0.03 rad.
}

TEST(Tracker, TheNearestContinuesTheTrack) {
  Tracker tracker;
  tracker.Assign(0, {At(0)});
  EXPECT_EQ(tracker.Assign(50'000, {At(0.02), At(0.01)}), (Ids{1, 0}));
}

TEST(Tracker, ForgetsAfterASecond) {
  Tracker tracker;
  tracker.Assign(0, {At(0)});
  tracker.Assign(500'000, {});
  EXPECT_EQ(tracker.Assign(1'000'000, {At(0)}), Ids{0});
  EXPECT_EQ(tracker.Assign(2'000'001, {At(0)}), Ids{1});
}

}  // namespace
}  // namespace windhover
