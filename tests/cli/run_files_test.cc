#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/manifest.h"
#include "cli/progress.h"
#include "cli/run_directory.h"
#include "common/config/fields.h"
#include "common/file/sha256.h"
#include "common/file/whole_file.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string TextOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(Sha256OfFile, WorkedExamples) {  // FIPS 180-2, appendix B.1, and the empty message.
  const TemporaryFolder folder;
  EXPECT_EQ(Sha256OfFile(folder.Write("abc", "abc")),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256OfFile(folder.Write("empty", "")),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256OfFile(folder.path() / "none"), "");
}

TEST(ReplaceFile, LeavesNothingBeside) {
  const TemporaryFolder folder;
  ReplaceFile(folder.path() / "a", "one");
  ReplaceFile(folder.path() / "a", "two");
  EXPECT_EQ(TextOf(folder.path() / "a"), "two");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  EXPECT_THROW(ReplaceFile(folder.path() / "no/folder", "x"), std::runtime_error);
}

TEST(MakeRunDirectory, CountsUp) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_EQ(MakeRunDirectory("scenarios/x.yaml", ""), "runs/x-1");
  EXPECT_EQ(MakeRunDirectory("x.yaml", ""), "runs/x-2");
  fs::current_path(before);
}

TEST(MakeRunDirectory, RemovesAnEarlierRunButNothingElse) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  EXPECT_EQ(MakeRunDirectory("x.yaml", out), out);
  folder.Write("out/resolved.yaml", "a: 1");
  folder.Write("out/run.lcm", "log");
  folder.Write("out/logs/sim.log", "text");
  folder.Write("out/notes.txt", "mine");
  MakeRunDirectory("x.yaml", out);
  EXPECT_FALSE(fs::exists(out / "run.lcm"));
  EXPECT_FALSE(fs::exists(out / "logs"));
  EXPECT_TRUE(fs::exists(out / "notes.txt"));
}

TEST(MakeRunDirectory, RefusesForeignFolders) {
  const TemporaryFolder folder;
  folder.Write("home/letter.txt", "dear");
  EXPECT_THROW(MakeRunDirectory("x.yaml", folder.path() / "home"), ConfigError);
  EXPECT_THROW(MakeRunDirectory("x.yaml", folder.path() / "home/letter.txt"), ConfigError);
  EXPECT_TRUE(fs::exists(folder.path() / "home/letter.txt"));
}

TEST(ProgressText, WorkedExample) {
  EXPECT_EQ(ProgressText(50, 200, 10), "[#######.......................] 50/200  25 % 30 s to go");
  EXPECT_THAT(ProgressText(200, 200, 40), HasSubstr("100 % 0 s to go"));
}

TEST(Timing, WorkedExample) {
  Scenario scenario;
  scenario.frame_rate_hz = 10;
  scenario.aircraft.resize(3);
  scenario.aircraft[0].self.carries_rig = true;
  RunSummary summary;
  summary.n_ticks = 20;
  summary.wall_s = 4;
  summary.stages["render-0"] = {{{"stage", "render"}, {"n", 20}, {"wall_ms", 2000.0}}};
  summary.stages["estimator-0"] = {{{"stage", "detect"}, {"n", 20}, {"wall_ms", 1000.0}},
                                   {{"stage", "estimate"}, {"n", 20}, {"wall_ms", 200.0}}};
  summary.stages["render-1"] = {{{"stage", "render"}, {"n", 20}, {"wall_ms", 1900.0}}};
  summary.stages["sim"] = {{{"stage", "wait"}, {"n", 20}, {"wall_ms", 4000.0}}};
  const auto timing = Timing(scenario, summary);
  EXPECT_EQ(timing["real_time_factor"], 0.5);  // 2 s simulated in 4 s.
  EXPECT_EQ(timing["stereo_pairs_per_s"], 5);  // 20 pairs of one rig in 4 s.
  EXPECT_EQ(timing["ms"]["render"], 100);
  EXPECT_EQ(timing["ms"]["detect"], 50);
  EXPECT_EQ(timing["ms"]["estimate"], 10);
  EXPECT_EQ(timing["ms"]["transport"], 40);  // A wait of 200 ms less the above.
}

TEST(Timing, OfARunWithoutATickHasNoRates) {
  const auto timing = Timing(Scenario{}, RunSummary{});
  EXPECT_TRUE(timing["real_time_factor"].is_null());
  EXPECT_TRUE(timing["stereo_pairs_per_s"].is_null());
}

}  // namespace
}  // namespace windhover
