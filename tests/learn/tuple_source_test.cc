// Tuples are drawn without bus, log and estimator: they must be what a run puts on the bus.

#include "learn/tuple_source.h"

#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "eval/run_log_record.h"
#include "eval/samples.h"
#include "learn/method_trial.h"
#include "learn/recorded_tuples.h"
#include "scenarios/dataset.h"
#include "tests/support/one_bus.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

Scenario Base(const std::string& preset, std::vector<std::string> overrides) {
  overrides.insert(overrides.end(),
                   {"observe=geometric", "aircraft=[{id: 0}]", "description=a small data set",
                    "dataset.splits.train.flights=2", "dataset.splits.train.pairs=81",
                    "dataset.splits.val.flights=1", "dataset.splits.val.pairs=20",
                    "dataset.splits.test.flights=1", "dataset.splits.test.pairs=30"});
  const std::filesystem::path presets = WINDHOVER_SOURCE_DIR "/scenarios/presets";
  return LoadUndrawnScenario(presets / (preset + ".yaml"), overrides);
}

// A run in one process, as its log tells it.
RunRecord Flown(const Scenario& scenario) {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.path() / "run.lcm";
  const RunOutcome outcome = RunOnOneBus(scenario, log);
  EXPECT_TRUE(outcome.valid) << outcome.reason;
  return ReadRunRecord(log);
}

std::vector<StereoTuple> FlownThroughTheLoop(const Scenario& flight, int number) {
  std::vector<StereoTuple> tuples;
  for (const TargetFrame& frame : CollectTargetFrames(Flown(flight)).frames) {
    if (!frame.box) continue;
    tuples.push_back({.box = *frame.box,
                      .range_m = frame.reference_m,
                      .range_true_m = frame.truth.range_m,
                      .flight = number,
                      .utime = frame.utime});
  }
  return tuples;
}

std::vector<double> Numbers(const StereoTuple& tuple) {
  const image_box_t &l = tuple.box.left, &r = tuple.box.right;
  return {l.x_px,
          l.y_px,
          l.w_px,
          l.h_px,
          r.x_px,
          r.y_px,
          r.w_px,
          r.h_px,
          tuple.box.score,
          tuple.range_m,
          tuple.range_true_m,
          static_cast<double>(tuple.flight),
          static_cast<double>(tuple.utime)};
}

void ExpectSameBits(const std::vector<StereoTuple>& drawn, const std::vector<StereoTuple>& flown) {
  ASSERT_EQ(drawn.size(), flown.size());
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    EXPECT_EQ(Numbers(drawn[i]), Numbers(flown[i])) << "tuple " << i;
  }
}

void ExpectAsFlown(const Scenario& base) {
  const TupleSplits drawn = DrawTuples(base, 5, 1);
  std::vector<StereoTuple> train;
  for (int flight = 0; flight < 2; ++flight) {
    const auto one = FlownThroughTheLoop(DatasetFlight(base, Split::kTrain, flight, 5), flight);
    train.insert(train.end(), one.begin(), one.end());
  }
  EXPECT_GT(train.size(), 60U);
  ExpectSameBits(drawn.train, train);
  ExpectSameBits(drawn.test, FlownThroughTheLoop(DatasetFlight(base, Split::kTest, 0, 5), 0));
}

TEST(TupleSource, DrawsWhatARunOfThePapersPresetDetects) { ExpectAsFlown(Base("uavde_12mm", {})); }

TEST(TupleSource, DrawsWhatARunDetectsOfARigThatRotorsShake) {
  ExpectAsFlown(Base("resonant", {"geometric.miss_rate=0.2", "exposure.shutter=rolling"}));
}

TEST(TupleSource, DrawsWhatARunDetectsInWindWithSkewedTriggers) {
  ExpectAsFlown(Base("pretrain", {"exposure.skew_ms=5", "uwb.label=nearest"}));
}

TEST(TupleSource, SplitsAreOfTheSizesThatTheDataSetAsksFor) {
  const TupleSplits drawn = DrawTuples(Base("uavde_12mm", {"geometric.miss_rate=0"}), 1, 1);
  EXPECT_EQ(drawn.train.size(), 81U);
  EXPECT_EQ(drawn.val.size(), 20U);
  EXPECT_EQ(drawn.test.size(), 30U);
}

TEST(TupleSource, AnyNumberOfThreadsDrawsTheSameAndAnotherSeedOthers) {
  const Scenario base = Base("uavde_12mm", {});
  const TupleSplits one = DrawTuples(base, 1, 1), three = DrawTuples(base, 1, 3);
  ExpectSameBits(one.train, three.train);
  ExpectSameBits(one.val, three.val);
  EXPECT_NE(Numbers(DrawTuples(base, 2, 1).test[0]), Numbers(one.test[0]));
}

TEST(RecordedTuples, AreThoseOfAsManyFlightsSplitByRun) {
  const Scenario base = Base("uavde_12mm", {"geometric.miss_rate=0.1"});
  std::vector<RunRecord> runs = {Flown(DatasetFlight(base, Split::kTrain, 0, 5)),
                                 Flown(DatasetFlight(base, Split::kTrain, 1, 5)),
                                 Flown(DatasetFlight(base, Split::kVal, 0, 5)),
                                 Flown(DatasetFlight(base, Split::kTest, 0, 5))};
  const RecordedTuples recorded = TuplesOfRuns(runs, {"a", "b", "c", "d"});
  const TupleSplits drawn = DrawTuples(base, 5, 1);
  EXPECT_TRUE(recorded.split_by_run);
  EXPECT_EQ(recorded.rig.baseline_m, 0.406);
  ExpectSameBits(recorded.tuples.train, drawn.train);
  ExpectSameBits(recorded.tuples.val, drawn.val);
  ExpectSameBits(recorded.tuples.test, drawn.test);
  const auto message = [&] {
    try {
      TuplesOfRuns(runs, {"a", "b", "c", "d"});
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  runs[1].scenario.rig.calibrated.focal_mm = 16;
  EXPECT_EQ(message(), "b: must have flown the same calibrated rig as the first run");
  runs[0].valid = false;
  runs[0].invalid_reason = "cut short";
  EXPECT_EQ(message(), "a: must be a valid run (found: cut short)");
}

TEST(RecordedTuples, OneFlightIsSplitByTime) {
  Scenario base = Base("uavde_12mm", {});
  base.dataset.splits.train.pairs = 800;
  const Scenario flight = DatasetFlight(base, Split::kTrain, 0, 5);
  const RecordedTuples recorded = TuplesOfRuns({Flown(flight)}, {"a"});
  const auto& [train, val, test] = recorded.tuples;
  const auto all = FlownThroughTheLoop(flight, 0);
  EXPECT_FALSE(recorded.split_by_run);
  EXPECT_EQ(train.size(), all.size() * 2815 / 3895);
  EXPECT_EQ(Numbers(train.front()), Numbers(all.front()));
  EXPECT_EQ(Numbers(test.back()), Numbers(all.back()));
  EXPECT_GE(val.front().utime - train.back().utime, 1'000'000);
  EXPECT_GE(test.front().utime - val.back().utime, 1'000'000);
  EXPECT_GT(train.size() + val.size() + test.size() + 25, all.size());  // 10 a second.
}

// Methods that remember, too, need no loop to be scored.
TEST(MethodTrial, GivesTheDistancesOfARun) {
  const Scenario base = Base("uavde_12mm", {"geometric.miss_rate=0.1"});
  const Scenario flight = DatasetFlight(base, Split::kTest, 0, 3);
  std::vector<TrialMethod> methods;
  for (const std::string& method : flight.estimator.methods) methods.push_back({method, ""});
  const auto tried = TryMethods({flight}, methods, 1);
  const std::vector<TargetFrame> flown = CollectTargetFrames(Flown(flight)).frames;
  ASSERT_EQ(tried[0].size(), flown.size());
  for (std::size_t i = 0; i < flown.size(); ++i) {
    EXPECT_EQ(tried[0][i].reference_m, flown[i].reference_m);
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const auto& estimate = flown[i].estimates[m];
      // No estimate is as good as none: 0.
      EXPECT_EQ(tried[0][i].range_m[m].value_or(0), estimate ? estimate->range_m : 0) << i;
    }
  }
}

}  // namespace
}  // namespace windhover
