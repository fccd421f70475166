#include "eval/samples.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/flight_fixture.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

annotation_t Truth(std::vector<target_annotation_t> targets) {
  annotation_t truth{};
  truth.n_targets = static_cast<int>(targets.size());
  truth.targets = std::move(targets);
  return truth;
}

detection_t Detections(const std::vector<double>& left_x_px) {
  detection_t detections{};
  for (const double x_px : left_x_px) {
    detections.boxes.push_back(StereoBox(Box(x_px, 360, 40, 20), Box(x_px - 50, 360, 40, 20)));
  }
  return detections;
}

TEST(Associate, JoinsEachBoxToTheNearestTarget) {
  const auto truth = Truth({TargetAhead(1, 10, 300), TargetAhead(2, 20, 700)});
  const auto target_of = Associate(Detections({705, 310}), truth);
  EXPECT_EQ(target_of[0], 1u);
  EXPECT_EQ(target_of[1], 0u);
}

TEST(Associate, TheNearerOfTwoBoxesGetsTheTarget) {
  const auto target_of = Associate(Detections({315, 303}), Truth({TargetAhead(1, 10, 300)}));
  EXPECT_FALSE(target_of[0]);
  EXPECT_EQ(target_of[1], 0u);
}

TEST(Associate, ReachesAsFarAsTheLargerBox) {
  const auto truth = Truth({TargetAhead(1, 10, 300)});  // 40 px wide
  EXPECT_TRUE(Associate(Detections({339}), truth)[0]);
  EXPECT_FALSE(Associate(Detections({341}), truth)[0]);
}

TEST(Associate, IgnoresTargetsBehindTheCamera) {
  auto behind = TargetAhead(1, 10, 300);
  behind.left.in_front = 0;
  EXPECT_FALSE(Associate(Detections({300}), Truth({behind}))[0]);
}

TEST(CollectTargetFrames, CountsFalseDetectionsAndMisses) {
  ObserverFrame frame = SeenFrame(0, TargetAhead(1, 10, 300), 10);
  frame.detections = Detections({900});
  const auto collected = CollectTargetFrames(Flight({frame}));
  EXPECT_EQ(collected.false_detections, 1);
  ASSERT_EQ(collected.frames.size(), 1u);
  EXPECT_FALSE(collected.frames[0].box);
  EXPECT_FALSE(collected.frames[0].estimates[0]);
}

TEST(CollectTargetFrames, LeavesOutTargetsThatAreNotInViewOfBoth) {
  auto outside = TargetAhead(1, 10);
  outside.right.truncation = 1;
  auto behind = TargetAhead(1, 10);
  behind.left.in_front = 0;
  auto cut = TargetAhead(1, 10);
  cut.right.truncation = 0.9;
  const auto collected = CollectTargetFrames(
      Flight({MissedFrame(0, outside), MissedFrame(100'000, behind), MissedFrame(200'000, cut)}));
  ASSERT_EQ(collected.frames.size(), 1u);
  EXPECT_EQ(collected.frames[0].utime, 200'000);
}

TEST(CollectTargetFrames, TakesTheReferenceOfTheScenario) {
  auto target = TargetAhead(1, 10);
  target.range_m = 11;
  ObserverFrame frame = SeenFrame(0, target, 10);
  frame.uwb_m[1] = 12;
  RunRecord run = Flight({frame});
  run.scenario.score.reference = ScoreReference::kRange;
  EXPECT_EQ(CollectTargetFrames(run).frames[0].reference_m, 11);
  run.scenario.score.reference = ScoreReference::kDepth;
  EXPECT_EQ(CollectTargetFrames(run).frames[0].reference_m, 10);
  run.scenario.score.reference = ScoreReference::kUwb;
  EXPECT_EQ(CollectTargetFrames(run).frames[0].reference_m, 12);
  run.frames[0].uwb_m.clear();
  EXPECT_TRUE(CollectTargetFrames(run).frames.empty());
  EXPECT_EQ(CollectTargetFrames(run).no_reference, 1);
}

TEST(CollectTargetFrames, AnImpossibleRangeIsNoEstimate) {
  for (const double range_m :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto run = Flight({SeenFrame(0, TargetAhead(1, 10), range_m)});
    EXPECT_FALSE(CollectTargetFrames(run).frames[0].estimates[0]) << range_m;
  }
  RunRecord run = Flight({SeenFrame(0, TargetAhead(1, 10), 10)});
  EXPECT_TRUE(CollectTargetFrames(run).frames[0].estimates[0]);
  run.frames[0].ranges->estimates[0].status = range_estimate_t::STATUS_NO_ESTIMATE;
  EXPECT_FALSE(CollectTargetFrames(run).frames[0].estimates[0]);
}

}  // namespace
}  // namespace windhover
