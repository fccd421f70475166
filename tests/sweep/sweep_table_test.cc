#include "sweep/sweep_table.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "eval/bootstrap.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

SweepPlan TwoPoints() {
  SweepPlan plan;
  plan.factors.emplace_back(FactorConfig{.key = "a", .values = {"1", "2"}});
  plan.points = {{"1"}, {"2"}};
  plan.metrics = {"methods.baseline.abs_rel", "swarm.collisions"};
  return plan;
}

RunRow Row(int point, std::uint64_t seed, std::optional<double> error, double collisions = 0) {
  return {.point = point,
          .seed = seed,
          .verdict = "pass",
          .reason = "",
          .metrics = {error, collisions}};
}

RunRows Rows(const std::vector<RunRow>& rows) {
  RunRows by_key;
  for (const RunRow& row : rows) by_key[{row.point, row.seed}] = row;
  return by_key;
}

TEST(Journal, GivesBackWhatWasAppendedInAnyOrder) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "runs.jsonl";
  {
    const Journal journal(file);
    journal.Append(Row(1, 5, 0.1 + 0.2));
    journal.Append(Row(0, 9, std::nullopt));
    journal.Append(
        {.point = 0, .seed = 9, .verdict = "invalid", .reason = "a \"b\"\n", .metrics = {}});
  }
  const RunRows rows = ReadJournal(file);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows.at({1, 5}).metrics[0], 0.1 + 0.2) << "the same bits";
  EXPECT_EQ(rows.at({0, 9}).reason, "a \"b\"\n") << "the last one counts";
}

TEST(Journal, LeavesOutALineThatWasCutOff) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "runs.jsonl";
  Journal(file).Append(Row(0, 1, 0.5));
  const std::string whole = TextOf(file);
  for (std::size_t n = 0; n <= whole.size(); ++n) {
    folder.Write("cut.jsonl", whole + whole.substr(0, n));
    EXPECT_EQ(ReadJournal(folder.path() / "cut.jsonl").size(), 1u);
  }
  EXPECT_TRUE(ReadJournal(folder.path() / "none").empty());
}

// Means 2 and 4; a missing value is left out, an invalid run too.
TEST(SweepTable, SummarisesThePointsOverTheirRuns) {
  RunRow invalid{.point = 1, .seed = 3, .verdict = "invalid", .reason = "x", .metrics = {}};
  const auto points = SummarisePoints(
      TwoPoints(),
      Rows({Row(0, 1, 1), Row(0, 2, 3), Row(0, 3, std::nullopt), Row(1, 1, 4), invalid}));
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(*points[0].metrics[0].mean, 2);
  EXPECT_EQ(points[0].metrics[0].n, 2);
  EXPECT_EQ(points[0].n_runs, 3);
  EXPECT_EQ(*points[1].metrics[0].mean, 4);
  EXPECT_EQ(points[1].n_invalid, 1);
  EXPECT_FALSE(points[1].metrics[0].ci95) << "one run has no interval";
}

TEST(SweepTable, WritesOneRowARunAndOneAPoint) {
  const SweepPlan plan = TwoPoints();
  const RunRows rows = Rows({Row(1, 2, 0.25, 1), Row(0, 1, std::nullopt), Row(0, 2, 0.1)});
  EXPECT_EQ(TableCsv(plan, rows),
            "point,seed,a,verdict,methods.baseline.abs_rel,swarm.collisions\n"
            "0,1,1,pass,,0\n"
            "0,2,1,pass,0.1,0\n"
            "1,2,2,pass,0.25,1\n");
  EXPECT_THAT(PointsCsv(plan, SummarisePoints(plan, rows)),
              HasSubstr("1,2,1,0,0,0.25,,,1,1,,,1\n"));
}

TEST(SweepTable, QuotesWordsWithCommas) {
  SweepPlan plan = TwoPoints();
  plan.points = {{"x, \"y\""}};
  EXPECT_THAT(TableCsv(plan, Rows({Row(0, 1, 1)})), HasSubstr("0,1,\"x, \"\"y\"\"\",pass,1,0\n"));
}

// Normal values of deviation 0.1: the interval of n of them is about 2 · 1.96 · 0.1 / √n wide, so
// 0.1 takes 16 runs; between 8 and 40 allows for the scatter of one sample.
TEST(StopRule, HoldsWhenTheIntervalIsNarrow) {
  const StopConfig stop{.metric = "m", .width = 0.1, .min_seeds = 5};
  std::vector<std::optional<double>> values;
  for (int i = 0; i < 100 && !IsNarrowEnough(stop, values); ++i) {
    values.push_back(0.1 * std::sqrt(2) * std::sin(2.4 * i));
  }
  EXPECT_GE(values.size(), 8u);
  EXPECT_LE(values.size(), 40u);
  EXPECT_FALSE(IsNarrowEnough(stop, {1.0, 1.0, 1.0, 1.0})) << "too few";
  EXPECT_TRUE(IsNarrowEnough(stop, {1.0, 1.0, 1.0, 1.0, 1.0}));
  EXPECT_FALSE(IsNarrowEnough({}, {1.0, 1.0, 1.0, 1.0, 1.0})) << "no rule";
}

TEST(SweepGates, AreHeldAtThePointsThatTheyAreFor) {
  SweepPlan plan = TwoPoints();
  const auto points =
      SummarisePoints(plan, Rows({Row(0, 1, 0.1), Row(0, 2, 0.12), Row(1, 1, 0.5)}));
  const auto failing = [&](double Expectation::*kind, double limit, SweepGate gate) {
    gate.expectation.metric = "methods.baseline.abs_rel";
    gate.expectation.*kind = limit;
    plan.config.gates = {gate};
    std::vector<std::string> names;
    for (const GateResult& result : EvaluateSweepGates(plan, points)) {
      if (!result.pass) names.push_back(result.name);
    }
    return names;
  };
  EXPECT_THAT(failing(&Expectation::max, 0.2, {}),
              ElementsAre("methods.baseline.abs_rel max at a = 2"));
  EXPECT_THAT(failing(&Expectation::max, 0.2, {.where = "a", .to = 1}), ElementsAre());
  EXPECT_EQ(failing(&Expectation::max, 0.01, {.where = "a", .from = 1, .to = 1}).size(), 1u);
  EXPECT_EQ(failing(&Expectation::upper95, 0.2, {}).size(), 1u) << "no interval of one run";
}

}  // namespace
}  // namespace windhover
