// The command itself, with its processes.

#include <algorithm>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "sweep/journal.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string kWindhover = std::string(WINDHOVER_BIN_DIR) + "/windhover";

/// 15 points of 4 short runs.
const std::string kSweep =
    "base: " WINDHOVER_SOURCE_DIR
    "/scenarios/ideal_geometric.yaml\n"
    "description: d\n"
    "set: {duration_s: 1, expect: [], geometric: {sigma_px: 1}}\n"
    "factors:\n"
    "  - {key: rig.focal_mm, values: [8, 12, 16]}\n"
    "  - {key: rig.misalignment.offset_px, min: 0, max: 20, levels: 5}\n"
    "seeds: {count: 4}\n"
    "metrics: [methods.baseline.abs_rel, methods.baseline.bias_m, frames.targets_in_view]\n";
constexpr std::size_t kRuns = 60;

class SweepCommand : public testing::Test {
 protected:
  SweepCommand() { file_ = folder_.Write("sweep.yaml", kSweep); }

  std::string Out(const std::string& name) const { return folder_.path() / name; }

  /// Exit status of a sweep; what it said is in `said_`.
  int Run(std::vector<std::string> words) {
    words.insert(words.begin(), {kWindhover, "sweep"});
    Program program(words);
    const int status = program.Wait();
    said_ = program.Out() + program.Err();
    return status;
  }

  std::string Table(const std::string& name) const {
    return TextOf(folder_.path() / name / "table.csv");
  }

  TemporaryFolder folder_;
  std::string file_, said_;
};

TEST_F(SweepCommand, AnyNumberOfWorkersAndAnyShardsMakeOneTable) {
  ASSERT_EQ(Run({file_, "--out", Out("whole"), "--jobs", "1"}), 0) << said_;
  const std::string table = Table("whole");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), static_cast<int>(kRuns) + 1);
  EXPECT_FALSE(fs::exists(Out("whole/work"))) << "nothing is left of runs that pass";
  EXPECT_FALSE(fs::exists(Out("whole/failed")));
  for (const std::string i : {"0", "1", "2"}) {
    ASSERT_EQ(Run({file_, "--out", Out(i), "--jobs", "2", "--shard", i + "/3"}), 0) << said_;
  }
  EXPECT_EQ(Run({"merge", Out("0"), Out("2"), "--out", Out("part")}), 2);
  EXPECT_THAT(said_,
              HasSubstr("DIR: must be all shards of the sweep, and those finished (found not "
                        "all runs of point 1: rig.focal_mm = 8, "));
  ASSERT_EQ(Run({"merge", Out("2"), Out("0"), Out("1"), "--out", Out("merged")}), 0) << said_;
  EXPECT_EQ(Table("merged"), table);
  EXPECT_EQ(TextOf(folder_.path() / "merged/points.csv"),
            TextOf(folder_.path() / "whole/points.csv"));
}

// Ten times, each after a time that is drawn anew, from before the first run to the last ones.
TEST_F(SweepCommand, KilledTenTimesAndResumedItMakesTheSameTable) {
  ASSERT_EQ(Run({file_, "--out", Out("undisturbed"), "--jobs", "2"}), 0) << said_;
  RandomStream random(7, "kill");
  int n_in_the_middle = 0;
  for (int kill = 0; kill < 10; ++kill) {
    Program sweep({kWindhover, "sweep", file_, "--out", Out("killed"), "--jobs", "2", "--resume"});
    const std::size_t goal =
        std::min(kRuns - 1, ReadJournal(Out("killed/runs.jsonl")).size() +
                                static_cast<std::size_t>(random.Uniform() * 10));
    while (ReadJournal(Out("killed/runs.jsonl")).size() < goal) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    std::this_thread::sleep_for(
        std::chrono::microseconds(static_cast<int>(random.Uniform() * 20000)));
    sweep.Signal(SIGKILL);
    sweep.Wait();
    const std::size_t n = ReadJournal(Out("killed/runs.jsonl")).size();
    n_in_the_middle += n > 0 && n < kRuns ? 1 : 0;
  }
  EXPECT_GE(n_in_the_middle, 5) << "the kills must meet a sweep at work";
  ASSERT_EQ(Run({file_, "--out", Out("killed"), "--jobs", "2", "--resume"}), 0) << said_;
  EXPECT_EQ(Table("killed"), Table("undisturbed"));
}

TEST_F(SweepCommand, InterruptedItSaysHowToGoOn) {
  folder_.Write("sweep.yaml", kSweep + "keep: 1\n");
  Program sweep({kWindhover, "sweep", file_, "--out", Out("o"), "--jobs", "1"});
  while (ReadJournal(Out("o/runs.jsonl")).empty()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  sweep.Signal(SIGINT);
  EXPECT_EQ(sweep.Wait(), 130);
  EXPECT_THAT(sweep.Err(), HasSubstr("--resume"));
  EXPECT_EQ(Run({file_, "--out", Out("o"), "--resume"}), 0) << said_;
}

TEST_F(SweepCommand, AFailingGateIsExitCode1AndFailingRunsAreKept) {
  folder_.Write("sweep.yaml", kSweep +
                                  "gates: [{metric: methods.baseline.abs_rel, max: 0.1}]\n"
                                  "keep: 3\n");
  std::string text = TextOf(file_);
  const std::string none = "expect: []";
  text.replace(text.find(none), none.size(),
               "expect: [{metric: methods.baseline.abs_rel, max: 0.1}]");
  folder_.Write("sweep.yaml", text);
  EXPECT_EQ(Run({file_, "--out", Out("o"), "--jobs", "2"}), 1);
  EXPECT_THAT(said_, HasSubstr("FAIL methods.baseline.abs_rel max at rig.focal_mm = "));
  EXPECT_THAT(TextOf(folder_.path() / "o/junit.xml"), HasSubstr("<failure"));
  int n_kept = 0;
  for (const auto& entry : fs::directory_iterator(Out("o/failed"))) {
    ++n_kept;
    EXPECT_TRUE(fs::exists(entry.path() / "resolved.yaml"));
    EXPECT_TRUE(fs::exists(entry.path() / "run.lcm"));
    EXPECT_TRUE(fs::exists(entry.path() / "report.html"));
  }
  EXPECT_EQ(n_kept, 3);
}

TEST_F(SweepCommand, WhatIsWrongIsSaidBeforeAnythingRuns) {
  const auto refuses = [&](std::vector<std::string> words, const std::string& message) {
    EXPECT_EQ(Run(words), 2) << said_;
    EXPECT_THAT(said_, StartsWith("windhover: error: "));
    EXPECT_THAT(said_, HasSubstr(message));
  };
  refuses({}, "SWEEP: must be given");
  refuses({file_}, "--out: must be given");
  refuses({file_, "--out", Out("o"), "--shard", "3/3"}, "--shard: must be i/n with 0 <= i < n");
  refuses({file_, "--out", Out("o"), "--shard", "a"}, "--shard: must be i/n with 0 <= i < n");
  refuses({file_, "--out", Out("o"), "--jobs", "0"}, "--jobs");
  refuses({"no/such.yaml", "--out", Out("o")}, "no/such.yaml: must be a readable file");
  refuses({"merge", Out("none"), "--out", Out("o")}, "plan.json: must be the plan.json of a sweep");
  EXPECT_FALSE(fs::exists(Out("o")));
  const fs::path wrong =
      folder_.Write("wrong.yaml", kSweep + "gates: [{metric: a, max: 1}]\nkep: 2\n");
  refuses({wrong, "--out", Out("o")}, "kep: must be a known key; did you mean 'keep'?");
  EXPECT_FALSE(fs::exists(Out("o")));

  folder_.Write("full/file", "x");
  refuses({file_, "--out", Out("full")}, "--out: must be empty, new, or the folder of a sweep");
  ASSERT_EQ(Run({file_, "--out", Out("o"), "--shard", "0/15"}), 0) << said_;
  refuses({file_, "--out", Out("o")}, "unless --resume is given");
  refuses({file_, "--out", Out("o"), "--resume"}, "of the same --shard");
  const fs::path other = folder_.Write("other.yaml", kSweep + "stop: {min_seeds: 3}\n");
  refuses({other, "--out", Out("o"), "--resume", "--shard", "0/15"}, "(found another 'stop' in ");
  ASSERT_EQ(Run({other, "--out", Out("p"), "--shard", "1/15"}), 0) << said_;
  refuses({"merge", Out("o"), Out("p"), "--out", Out("q")},
          "p/plan.json: must be of the same sweep as ");
}

// Slurm itself: a job array of real tasks. Most of the time is Slurm's own.
TEST_F(SweepCommand, SlurmMakesTheSameTable) {
  const std::string cluster = WINDHOVER_SOURCE_DIR "/tests/sweep/slurm_cluster.sh";
  Program sweep({cluster, kWindhover, "sweep", file_, "--out", Out("slurm"), "--executor", "slurm",
                 "--shards", "3", "--slurm-option", "--cpus-per-task=1"});
  const int status = sweep.Wait();
  if (status == 77) GTEST_SKIP() << sweep.Err();
  ASSERT_EQ(status, 0) << sweep.Out() << sweep.Err();
  ASSERT_EQ(Run({file_, "--out", Out("local"), "--jobs", "1"}), 0) << said_;
  EXPECT_EQ(Table("slurm"), Table("local"));
  EXPECT_TRUE(fs::exists(Out("slurm/shards/2/table.csv")));
  EXPECT_TRUE(fs::exists(Out("slurm/report.html")));
}

TEST_F(SweepCommand, WithoutSlurmItSaysWhatToInstall) {
  Program sweep({"/usr/bin/env", "PATH=/nowhere", kWindhover, "sweep", file_, "--out", Out("o"),
                 "--executor", "slurm"});
  EXPECT_EQ(sweep.Wait(), 4);
  EXPECT_THAT(sweep.Err(), HasSubstr("apt install slurm-client"));
  EXPECT_FALSE(fs::exists(Out("o")));
}

}  // namespace
}  // namespace windhover
