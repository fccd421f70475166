#include "eval/metrics.h"

#include <cmath>

#include <gtest/gtest.h>

namespace windhover {
namespace {

ScoredFrame Scored(double utime_s, double reference_m, std::optional<double> estimate_m,
                   double sigma_m = 1) {
  return {UtimeFromSeconds(utime_s), reference_m, estimate_m, sigma_m};
}

ErrorMetrics MetricsOf(const std::vector<ScoredFrame>& frames) {
  return ComputeErrorMetrics(frames, TimeBlocks(0, 10'000'000, 0.1, 2), 1);
}

TEST(ErrorMetrics, WorkedExample) {
  // Errors +2, -4 and one miss, at 10, 20 and 40 m; both sigmas 2 m.
  const auto metrics = MetricsOf({Scored(0, 10, 12, 2), Scored(3, 20, 16, 2), Scored(6, 40, {})});
  EXPECT_EQ(metrics.n, 3);
  EXPECT_EQ(metrics.detected, 2);
  EXPECT_DOUBLE_EQ(*metrics.abs_rel, (0.2 + 0.2) / 2);
  EXPECT_DOUBLE_EQ(*metrics.abs_rel_all, (0.2 + 0.2 + 1) / 3);
  EXPECT_DOUBLE_EQ(*metrics.sq_rel, (4 / 10.0 + 16 / 20.0) / 2);
  EXPECT_DOUBLE_EQ(*metrics.rmse_m, std::sqrt((4 + 16) / 2.0));
  EXPECT_DOUBLE_EQ(*metrics.bias_m, (2 - 4) / 2.0);
  EXPECT_DOUBLE_EQ(*metrics.delta_1_25, 0.5);  // 12/10 = 1.2 is in, 20/16 = 1.25 is not.
  EXPECT_DOUBLE_EQ(*metrics.nees, (1 + 4) / 2.0);
  EXPECT_DOUBLE_EQ(*metrics.coverage_95, 0.5);  // 1.96 * 2 m = 3.92 m.
}

TEST(ErrorMetrics, MissedFramesAloneScoreAnErrorOfOne) {
  const auto metrics = MetricsOf({Scored(0, 10, {}), Scored(3, 10, {})});
  EXPECT_EQ(metrics.detected, 0);
  EXPECT_DOUBLE_EQ(*metrics.abs_rel_all, 1);
  EXPECT_FALSE(metrics.abs_rel);
  EXPECT_FALSE(metrics.rmse_m);
  EXPECT_EQ(metrics.ci95.count("abs_rel"), 0u);
  EXPECT_EQ(metrics.ci95.count("abs_rel_all"), 1u);
}

TEST(ErrorMetrics, OfNothingHaveNoValue) {
  const auto metrics = MetricsOf({});
  EXPECT_EQ(metrics.n, 0);
  EXPECT_FALSE(metrics.abs_rel_all);
  EXPECT_TRUE(metrics.ci95.empty());
}

TEST(ErrorMetrics, AnEstimateWithoutSigmaHasNoSayInConsistency) {
  const auto metrics = MetricsOf({Scored(0, 10, 11, 0), Scored(1, 10, 12, 1)});
  EXPECT_DOUBLE_EQ(*metrics.nees, 4);
  EXPECT_DOUBLE_EQ(*metrics.coverage_95, 0);
}

TEST(ErrorMetrics, IntervalsHoldTheValue) {
  std::vector<ScoredFrame> frames;
  for (int k = 0; k < 100; ++k) frames.push_back(Scored(k * 0.1, 10, 10 + std::sin(0.7 * k)));
  const auto metrics = MetricsOf(frames);
  for (const char* name : {"abs_rel_all", "abs_rel", "sq_rel", "bias_m"}) {
    ASSERT_EQ(metrics.ci95.count(name), 1u) << name;
  }
  EXPECT_LT(metrics.ci95.at("abs_rel")[0], *metrics.abs_rel);
  EXPECT_GT(metrics.ci95.at("abs_rel")[1], *metrics.abs_rel);
  EXPECT_LT(metrics.ci95.at("bias_m")[0], *metrics.bias_m);
  EXPECT_GT(metrics.ci95.at("bias_m")[1], *metrics.bias_m);
}

TEST(ScoreMethods, SortsFramesByDistance) {
  const std::vector<ScoredFrame> frames{Scored(0, 4, 5), Scored(1, 5, 5), Scored(2, 19.9, 20),
                                        Scored(3, 20, 22), Scored(4, 41, {})};
  const auto score = ScoreMethods({"baseline"}, {frames}, 0.1, 1).front();
  EXPECT_EQ(score.all.n, 5);
  EXPECT_EQ(score.lt20.n, 3);
  EXPECT_EQ(score.gt20.n, 2);
  ASSERT_EQ(score.by_distance.size(), 5u);  // [0,5) [5,10) [15,20) [20,25) [40,45)
  EXPECT_EQ(score.by_distance[2].from_m, 15);
  EXPECT_EQ(score.by_distance[2].to_m, 20);
  EXPECT_EQ(score.by_distance[4].metrics.n, 1);
  EXPECT_EQ(score.by_distance[4].metrics.detected, 0);
  EXPECT_DOUBLE_EQ(*score.by_distance[0].metrics.abs_rel, 0.25);
}

TEST(ScoreMethods, SharedFramesAreThoseThatAllMethodsAnswer) {
  const std::vector<ScoredFrame> one{Scored(0, 10, 11), Scored(1, 10, {}), Scored(2, 10, 14)};
  const std::vector<ScoredFrame> other{Scored(0, 10, 12), Scored(1, 10, 13), Scored(2, 10, {})};
  const auto scores = ScoreMethods({"baseline", "size"}, {one, other}, 0.1, 1);
  EXPECT_EQ(scores[0].shared.n, 1);
  EXPECT_DOUBLE_EQ(*scores[0].shared.abs_rel, 0.1);
  EXPECT_DOUBLE_EQ(*scores[1].shared.abs_rel, 0.2);
}

TEST(Median, WorkedExample) {
  EXPECT_FALSE(Median({}));
  EXPECT_EQ(Median({5, 1, 3}), 3);
  EXPECT_EQ(Median({5, 1, 3, 4}), 3.5);
}

}  // namespace
}  // namespace windhover
