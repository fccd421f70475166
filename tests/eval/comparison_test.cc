#include "eval/comparison.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/eval/flight_fixture.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

Json Score(double abs_rel, int collisions) {
  return {{"methods",
           {{"baseline", {{"n", 10}, {"abs_rel", abs_rel}, {"ci95", {{"abs_rel", {0, 1}}}}}}}},
          {"swarm", {{"collisions", collisions}, {"order", nullptr}}}};
}

// Differences of 0.1, 0.2 and 0.3: every resampled mean lies between the least and the greatest.
TEST(CompareScores, WorkedExample) {
  const std::vector<Json> a = {Score(0.1, 0), Score(0.2, 0), Score(0.3, 1)};
  const std::vector<Json> b = {Score(0.2, 1), Score(0.4, 1), Score(0.6, 2)};
  const auto differences = CompareScores(a, b);
  ASSERT_EQ(differences.size(), 3u) << "n, abs_rel, collisions; order has no value";
  EXPECT_EQ(differences[1].metric, "methods.baseline.abs_rel");
  EXPECT_EQ(differences[1].n, 3);
  EXPECT_NEAR(differences[1].a, 0.2, 1e-12);
  EXPECT_NEAR(differences[1].Difference(), 0.2, 1e-12);
  ASSERT_TRUE(differences[1].ci95);
  EXPECT_GE((*differences[1].ci95)[0], 0.1 - 1e-12);
  EXPECT_LE((*differences[1].ci95)[1], 0.3 + 1e-12);
  EXPECT_LT((*differences[1].ci95)[0], 0.2);
  // One more collision in each pair: the runs differ, their difference does not.
  EXPECT_EQ(differences[2].metric, "swarm.collisions");
  EXPECT_NEAR((*differences[2].ci95)[0], 1, 1e-12);
  EXPECT_NEAR((*differences[2].ci95)[1], 1, 1e-12);
}

TEST(CompareScores, OnePairHasNoInterval) {
  const std::vector<Json> a = {Score(0.1, 0)}, b = {Score(0.3, 0)};
  const auto differences = CompareScores(a, b);
  EXPECT_NEAR(differences[1].Difference(), 0.2, 1e-12);
  EXPECT_FALSE(differences[1].ci95);
}

TEST(CompareScores, LeavesOutWhatOneLacks) {
  std::vector<Json> a = {Score(0.1, 0), Score(0.2, 0)}, b = {Score(0.3, 0), Score(0.5, 0)};
  a[0]["methods"]["baseline"]["abs_rel"] = nullptr;
  const auto differences = CompareScores(a, b);
  ASSERT_EQ(differences.size(), 3u);
  EXPECT_EQ(differences[2].metric, "methods.baseline.abs_rel") << "first seen in the second run";
  EXPECT_EQ(differences[2].n, 1);
  EXPECT_NEAR(differences[2].a, 0.2, 1e-12);
}

/// Ten seconds of a target at 10 m, estimated at `range_m`.
Evaluation Estimated(double range_m, std::size_t n = 100) {
  std::vector<ObserverFrame> frames;
  for (std::size_t i = 0; i < n; ++i) {
    frames.push_back(SeenFrame(static_cast<Utime>(i) * 100'000, TargetAhead(1, 10), range_m));
  }
  return EvaluateRecord(Flight(std::move(frames)));
}

// 1 m of 10 is 0.1, 3 m are 0.3; B has the first half of the frames.
TEST(CompareFrames, WorkedExample) {
  const auto differences = CompareFrames(Estimated(11), Estimated(7, 50));
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_EQ(differences[0].n, 50);
  EXPECT_NEAR(differences[0].a, 0.1, 1e-12);
  EXPECT_NEAR(differences[0].b, 0.3, 1e-12);
  ASSERT_TRUE(differences[0].ci95);
  EXPECT_NEAR((*differences[0].ci95)[1], 0.2, 1e-12);
}

TEST(DifferentKeys, AreListedWithBothValues) {
  Scenario a, b;
  b.vibration.level = 3;
  b.estimator.methods = {"baseline"};
  a.estimator.methods = {"baseline", "size"};
  EXPECT_THAT(DifferentKeys(a, a), ElementsAre());
  EXPECT_THAT(DifferentKeys(a, b), ElementsAre(HasSubstr("vibration.level: 1 → 3"),
                                               HasSubstr("estimator.methods.1: size → none")));
}

TEST(FindRegressions, HoldsEachMetricToItsLoss) {
  const Json before = Score(0.10, 0), now = Score(0.13, 0);
  const std::vector<AllowedLoss> allowed = {{"methods.baseline.abs_rel", 0.02},
                                            {"methods.baseline.abs_rel", 0.04},
                                            {"methods.baseline.n", 0},
                                            {"swarm.order", 0},
                                            {"swarm.wrong", 0}};
  const auto found = FindRegressions(before, now, allowed);
  ASSERT_EQ(found.size(), 5u);
  EXPECT_FALSE(found[0].pass);
  EXPECT_EQ(found[0].message, "worse by 0.03, allowed are 0.02");
  EXPECT_TRUE(found[1].pass);
  EXPECT_TRUE(found[2].pass);
  EXPECT_FALSE(found[3].pass);
  EXPECT_THAT(found[3].message, HasSubstr("no value"));
  EXPECT_FALSE(found[4].pass);
  EXPECT_THAT(found[4].message, HasSubstr("no 'wrong' among collisions, order"));
  EXPECT_TRUE(FindRegressions(now, before, allowed)[0].pass) << "better is not worse";
}

// Of detections more is better; a bias is as bad to either side.
TEST(FindRegressions, KnowsWhatIsWorse) {
  const auto score = [](int detected, double bias_m) {
    return Json{{"methods", {{"m", {{"n", 10}, {"detected", detected}, {"bias_m", bias_m}}}}}};
  };
  const std::vector<AllowedLoss> allowed = {{"methods.m.detected", 1}, {"methods.m.bias_m", 0.5}};
  const auto found = FindRegressions(score(10, -0.2), score(8, 1), allowed);
  EXPECT_NEAR(found[0].loss, 2, 1e-12);
  EXPECT_FALSE(found[0].pass);
  EXPECT_NEAR(found[1].loss, 0.8, 1e-12);
  EXPECT_TRUE(FindRegressions(score(8, 1), score(10, -0.2), allowed)[1].pass);
}

}  // namespace
}  // namespace windhover
