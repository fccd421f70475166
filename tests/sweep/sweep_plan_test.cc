#include "sweep/sweep_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::string kBase = "base: " WINDHOVER_SOURCE_DIR
                          "/scenarios/ideal_geometric.yaml\n"
                          "description: d\n";

SweepPlan Load(const std::string& text) {
  const TemporaryFolder folder;
  return LoadSweepPlan(folder.Write("sweep.yaml", kBase + text));
}

std::string Mistakes(const std::string& text) {
  const TemporaryFolder folder;
  const auto file = folder.Write("sweep.yaml", kBase + text);
  try {
    LoadSweepPlan(file);
  } catch (const ConfigError& error) {
    std::string what = error.what();
    for (std::size_t at; (at = what.find(file.string())) != std::string::npos;) {
      what.replace(at, file.string().size(), "S");
    }
    return what;
  }
  return "";
}

TEST(SweepPlan, PointsAreTheBaseWithFactorsSet) {
  const SweepPlan plan = Load(
      "set: {duration_s: 2, estimator: {methods: [baseline]}}\n"
      "factors:\n"
      "  - {key: rig.focal_mm, values: [8, 12]}\n"
      "  - {key: aircraft.0.yaw_deg, min: -5, max: 5, levels: 3}\n"
      "seeds: {first: 7, count: 3}\n");
  ASSERT_EQ(plan.points.size(), 6u);
  const Scenario scenario = plan.ScenarioAt(3);
  EXPECT_EQ(scenario.duration_s, 2);
  EXPECT_EQ(scenario.rig.calibrated.focal_mm, 12);
  EXPECT_EQ(scenario.aircraft[0].yaw_deg, -5);
  EXPECT_EQ(plan.Describe(3), "rig.focal_mm = 12, aircraft.0.yaw_deg = -5");
  EXPECT_EQ(plan.SeedOf(2), 9u);
  EXPECT_THAT(plan.metrics, testing::Contains("methods.baseline.abs_rel_all"));
}

TEST(SweepPlan, OneAtATimeBeginsWithTheBase) {
  const SweepPlan plan = Load(
      "design: {type: one_at_a_time}\n"
      "factors: [{key: rig.focal_mm, values: [8, 12, 16]}, {key: vibration.source, values: "
      "[none]}]\n");
  EXPECT_THAT(plan.points, ElementsAre(DesignPoint{"12", "none"}, DesignPoint{"8", "none"},
                                       DesignPoint{"16", "none"}));
}

TEST(SweepPlan, KeysThatFactorsSetAreNotDrawn) {
  const std::string draws = "set: {randomize: [{key: vibration.level, min: 3, max: 4}]}\n";
  EXPECT_EQ(Load(draws + "factors: [{key: vibration.level, values: [1]}]\n")
                .ScenarioAt(0)
                .randomize.size(),
            0u);
  EXPECT_EQ(
      Load(draws + "factors: [{key: rig.focal_mm, values: [8]}]\n").ScenarioAt(0).randomize.size(),
      1u);
}

TEST(SweepPlan, SaysWhereAFactorNamesNoKey) {
  EXPECT_THAT(Mistakes("factors:\n  - {key: rig.focal_m, values: [8]}\n"),
              HasSubstr("S:4:11: rig.focal_m: must be a known key; did you mean"));
  EXPECT_THAT(Mistakes("factors:\n  - {key: rig.focal_mm.left, values: [8]}\n"),
              HasSubstr("S:4:11: rig.focal_mm.left: must be a key inside a section"));
}

// 12 mm is allowed, 5000 mm at the other end of the range is not.
TEST(SweepPlan, SaysWhereARangeBreaksALimit) {
  const std::string mistakes =
      Mistakes("factors:\n  - key: rig.focal_mm\n    min: 12\n    max: 5000\n    levels: 2\n");
  EXPECT_THAT(mistakes, HasSubstr("S:6:10: rig.focal_mm: must be a number between"));
  EXPECT_THAT(mistakes, HasSubstr("(found '5000'); at point 1: rig.focal_mm = 5000"));
}

// Two aircraft at one place break a rule between keys, and only at one point.
TEST(SweepPlan, SaysAtWhichPointARuleIsBroken) {
  const std::string mistakes = Mistakes(
      "set: {aircraft: [{id: 0, carries_rig: true, position_m: [0, 0, 20]},"
      " {id: 1, position_m: [30, 0, 20]}]}\n"
      "factors:\n  - {key: aircraft.1.id, values: [1, 0, 2]}\n");
  EXPECT_THAT(mistakes, HasSubstr("at point 1: aircraft.1.id = 0"));
  EXPECT_THAT(mistakes, Not(HasSubstr("point 2")));
}

TEST(SweepPlan, ReportsAllMistakesOfTheFileAtOnce) {
  const std::string mistakes = Mistakes(
      "factors:\n"
      "  - {key: a, min: 5, max: 1}\n"                                   // 4
      "  - {key: b, min: 0, max: 1, scale: log}\n"                       // 5
      "  - {key: c}\n"                                                   // 6
      "  - {key: d, values: [1, 2, 1]}\n"                                // 7
      "  - {key: a, values: [1]}\n"                                      // 8
      "  - {key: random_seed, values: [1]}\n"                            // 9
      "  - {key: e, mean: 1}\n"                                          // 10
      "stop: {metric: methods.baseline.abs_rel, width: -1}\n"            // 11
      "gates: [{metric: methods.baseline.abs_rel, where: z, max: 1}]\n"  // 12
      "analysis: {x: flex.section, pareto: [a]}\n"                       // 13
      "retries: -1\n"                                                    // 14
      "seed: 1\n");                                                      // 15
  for (const char* expected :
       {"S:4:19: factors.0.min: must be below max, 1 (found '5')",
        "S:5:19: factors.1.min: must be above 0 where scale is log (found '0')",
        "S:6:5: factors.2: must be given values, min and max, or mean and sigma",
        "S:7:29: factors.3.values.2: must be given once (found '1' again)",
        "S:8:11: factors.4.key: must be unlike the key of every other factor (found 'a' again)",
        "S:9:11: factors.5.key: must be neither random_seed nor a gate",
        "S:10:5: factors.6: must be given both mean and sigma",
        "S:11:49: stop.width: must be above 0 (found '-1')",
        "S:12:51: gates.0.where: must be the key of a factor (found 'z')",
        "S:13:15: analysis.x: must be the key of a factor of numbers (found 'flex.section')",
        "S:13:37: analysis.pareto: must be two of metrics (found 1)",
        "S:14:10: retries: must be a whole number between 0 and 10 (found '-1')",
        "S:15:1: seed: must be a known key; did you mean 'seeds'?"}) {
    EXPECT_THAT(mistakes, HasSubstr(expected));
  }
}

TEST(SweepPlan, SaysWhichMetricNoRunHas) {
  const std::string mistakes = Mistakes(
      "metrics: [methods.baseline.abs_rel, methods.pcm.abs_rel, methods.size.abs_real, "
      "methods.size,"
      " methods.size.by_distance.30.abs_rel, methods.size.by_distance.far.abs_rel]\n"
      "gates: [{metric: swarm.order, min: 1}]\n");
  EXPECT_THAT(mistakes, HasSubstr("metrics.1: must be a number of score.json (found "
                                  "'methods.pcm.abs_rel': no 'pcm')"));
  EXPECT_THAT(mistakes, HasSubstr("metrics.2: "));
  EXPECT_THAT(mistakes, HasSubstr("metrics.3: "));
  EXPECT_THAT(mistakes, Not(HasSubstr("metrics.4: ")));
  EXPECT_THAT(mistakes, HasSubstr("metrics.5: "));
  EXPECT_THAT(mistakes, HasSubstr("gates.0.metric: must be one of metrics (found 'swarm.order')"));
}

TEST(SweepPlan, RefusesTooManyPoints) {
  EXPECT_THAT(Mistakes("factors:\n"
                       "  - {key: rig.focal_mm, min: 8, max: 25, levels: 1000}\n"
                       "  - {key: vibration.level, min: 0, max: 5, levels: 1000}\n"),
              HasSubstr("design: must be of at most 10000 points"));
}

TEST(SweepPlan, StoredPlansTellSweepsApart) {
  const TemporaryFolder folder;
  const std::string text = "factors: [{key: rig.focal_mm, values: [8, 12]}]\n";
  const auto json = PlanJson(Load(text), "1");
  const auto file = folder.Write("plan.json", json.dump());
  const StoredPlan stored = ReadPlan(file);
  EXPECT_EQ(stored.plan.points, Load(text).points);
  EXPECT_EQ(stored.plan.metrics, Load(text).metrics);
  const auto difference = [&](const std::string& other, const std::string& build = "1") {
    return DifferenceOfPlans(stored.json, PlanJson(Load(other), build));
  };
  EXPECT_EQ(difference(text), "");
  EXPECT_EQ(difference(text + "keep: 3\n"), "") << "changes no run";
  EXPECT_EQ(difference("factors: [{key: rig.focal_mm, values: [8, 13]}]\n"), "points");
  EXPECT_EQ(difference(text + "seeds: {count: 3}\n"), "seeds");
  EXPECT_EQ(difference(text + "set: {duration_s: 3}\n"), "scenario");
  EXPECT_EQ(difference(text, "2"), "build");
  EXPECT_THROW(ReadPlan(folder.Write("other.json", "{}")), ConfigError);
}

}  // namespace
}  // namespace windhover
