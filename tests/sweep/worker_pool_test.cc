#include "sweep/worker_pool.h"

#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sweep/sweep_table.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using testing::HasSubstr;

class WorkerPool : public testing::Test {
 protected:
  WorkerPool() {
    plan_ = LoadSweepPlan(folder_.Write(
        "sweep.yaml", "base: " WINDHOVER_SOURCE_DIR "/scenarios/ideal_geometric.yaml\n"
                      "description: d\n"
                      "metrics: [methods.baseline.abs_rel]\n"
                      "factors: [{key: rig.focal_mm, min: 8, max: 16, levels: 5}]\n"
                      "seeds: {count: 4}\n"));
  }

  static RunRow Measured(const Scenario& drawn) {
    return {.verdict = "pass",
            .reason = "",
            .metrics = {drawn.rig.calibrated.focal_mm / static_cast<double>(drawn.random_seed)}};
  }

  RunRows Run(const std::string& name, int jobs, const RunFunction& run) {
    const auto journal = folder_.path() / name;
    EXPECT_TRUE(RunPool(plan_, run, {.journal = journal, .jobs = jobs, .points = {0, 1, 2, 3, 4}}));
    return ReadJournal(journal);
  }

  /// How often this has been asked for `name`, by any process.
  int CountCalls(const std::string& name) const {
    std::ofstream(folder_.path() / name, std::ios::app) << "x";
    return static_cast<int>(std::filesystem::file_size(folder_.path() / name));
  }

  TemporaryFolder folder_;
  SweepPlan plan_;
};

TEST_F(WorkerPool, RowsDoNotDependOnTheNumberOfWorkers) {
  const auto run = [](const Scenario& drawn, std::size_t, const RunPlace&) {
    return Measured(drawn);
  };
  const std::string one = TableCsv(plan_, Run("1", 1, run));
  EXPECT_THAT(one, HasSubstr("4,2,16,pass,8\n"));
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), 1 + 5 * 4);
  EXPECT_EQ(TableCsv(plan_, Run("3", 3, run)), one);
}

TEST_F(WorkerPool, TriesAnInvalidRunAgain) {
  const auto run = [&](const Scenario& drawn, std::size_t point, const RunPlace& place) {
    if (point == 1 && drawn.random_seed == 2 && place.attempt == 0)
      throw std::runtime_error("once");
    if (point == 2 && drawn.random_seed == 3) throw std::runtime_error("always");
    return Measured(drawn);
  };
  const RunRows rows = Run("retry", 2, run);
  EXPECT_TRUE(rows.at({1, 2}).valid());
  EXPECT_FALSE(rows.at({2, 3}).valid());
  EXPECT_EQ(rows.at({2, 3}).reason, "always");
  EXPECT_EQ(rows.size(), 20u);
}

TEST_F(WorkerPool, OutlivesARunThatKillsItsProcess) {
  const auto run = [&](const Scenario& drawn, std::size_t point, const RunPlace&) {
    if (point == 3 && drawn.random_seed == 2) raise(SIGSEGV);
    if (point == 1 && drawn.random_seed == 4 && CountCalls("calls") == 1) raise(SIGKILL);
    return Measured(drawn);
  };
  const RunRows rows = Run("crash", 2, run);
  EXPECT_EQ(rows.size(), 20u);
  EXPECT_THAT(rows.at({3, 2}).reason, HasSubstr("signal 11"));
  EXPECT_TRUE(rows.at({3, 3}).valid()) << "the rest of the point goes on";
  EXPECT_TRUE(rows.at({1, 4}).valid()) << "the second attempt counts";
}

TEST_F(WorkerPool, DoesOnlyWhatTheJournalHasNot) {
  const auto journal = folder_.path() / "half";
  WriteJournal(journal, {{{0, 1}, {.point = 0, .seed = 1, .verdict = "pass", .metrics = {9.0}}}});
  const auto run = [&](const Scenario& drawn, std::size_t, const RunPlace&) {
    CountCalls("runs");
    return Measured(drawn);
  };
  const RunRows rows = Run("half", 2, run);
  EXPECT_EQ(rows.at({0, 1}).metrics[0], 9.0);
  EXPECT_EQ(CountCalls("runs"), 20) << "19 runs and this";
}

TEST_F(WorkerPool, StopsAPointWhenItsIntervalIsNarrow) {
  plan_.config.stop = {.metric = plan_.metrics[0], .width = 0.1, .min_seeds = 2};
  const auto run = [](const Scenario& drawn, std::size_t point, const RunPlace&) {
    RunRow row = Measured(drawn);
    if (point == 0) row.metrics = {1.0};
    return row;
  };
  const RunRows rows = Run("stop", 2, run);
  EXPECT_EQ(rows.size(), 2u + 4 * 4u);
}

}  // namespace
}  // namespace windhover
