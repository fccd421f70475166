#include "common/process/process.h"

#include <csignal>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "common/process/stage_timer.h"

namespace windhover {
namespace {

using testing::HasSubstr;

struct Outcome {
  int status = -1;
  bool ran = false;
  ProcessArgs args;
  std::string errors;
};

Outcome RunWith(std::vector<std::string> words, const std::function<void()>& body = nullptr) {
  words.insert(words.begin(), "windhover-x");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  Outcome outcome;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  outcome.status = RunProcess("windhover-x", "does x", static_cast<int>(argv.size()), argv.data(),
                              [&](const ProcessArgs& args) {
                                outcome.ran = true;
                                outcome.args = args;
                                if (body) body();
                              });
  outcome.errors = testing::internal::GetCapturedStderr();
  testing::internal::GetCapturedStdout();
  return outcome;
}

TEST(RunProcess, HandsOverItsArguments) {
  const Outcome outcome =
      RunWith({"s.yaml", "--lcm-url", "memq://", "--run-dir", "runs/a", "--run-id", "12", "--share",
               "1/3", "--threads", "4", "--record", "jpeg", "--preview"});
  EXPECT_EQ(outcome.status, 0);
  ASSERT_TRUE(outcome.ran) << outcome.errors;
  EXPECT_EQ(outcome.args.scenario_file, "s.yaml");
  EXPECT_EQ(outcome.args.url, "memq://");
  EXPECT_EQ(outcome.args.run_dir, "runs/a");
  EXPECT_EQ(outcome.args.run_id, 12);
  EXPECT_EQ(outcome.args.share.index, 1);
  EXPECT_EQ(outcome.args.share.count, 3);
  EXPECT_EQ(outcome.args.threads, 4);
  EXPECT_EQ(outcome.args.record, "jpeg");
  EXPECT_TRUE(outcome.args.preview);
}

TEST(RunProcess, TakesTheUrlFromTheEnvironment) {
  setenv("LCM_DEFAULT_URL", "memq://", 1);
  EXPECT_EQ(RunWith({"s.yaml"}).args.url, "memq://");
  unsetenv("LCM_DEFAULT_URL");
  EXPECT_EQ(RunWith({"s.yaml"}).status, 2);
}

TEST(RunProcess, WrongUsageIs2AndNamesTheArgument) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> table = {
      {{"--lcm-url", "memq://"}, "SCENARIO"},
      {{"s.yaml", "--lcm-url", "memq://", "--nonsense"}, "--nonsense"},
      {{"s.yaml", "--lcm-url", "memq://", "--record", "png"}, "png"},
      {{"s.yaml", "--lcm-url", "memq://", "--threads", "0"}, "--threads"},
      {{"s.yaml", "--lcm-url", "memq://", "--share", "3/3"}, "3/3"},
      {{"s.yaml", "--lcm-url", "memq://", "--share", "1"}, "--share"},
      {{"s.yaml", "--lcm-url", "memq://", "--share", "-1/2"}, "--share"},
      {{"s.yaml", "--lcm-url", "memq://", "--share", "1/2x"}, "--share"},
  };
  for (const auto& [words, name] : table) {
    const Outcome outcome = RunWith(words);
    EXPECT_EQ(outcome.status, 2) << name;
    EXPECT_FALSE(outcome.ran) << name;
    EXPECT_THAT(outcome.errors, HasSubstr(name));
  }
}

TEST(RunProcess, HelpIs0) { EXPECT_EQ(RunWith({"--help"}).status, 0); }

TEST(RunProcess, ExceptionsBecomeOneLineAndAStatus) {
  const std::vector<std::string> words = {"s.yaml", "--lcm-url", "memq://"};
  const Outcome config = RunWith(words, [] { throw ConfigError("s.yaml:1:1: a: is missing"); });
  EXPECT_EQ(config.status, 2);
  EXPECT_EQ(config.errors, "windhover-x: error: s.yaml:1:1: a: is missing\n");
  const Outcome other = RunWith(words, [] { throw std::runtime_error("the hub is gone"); });
  EXPECT_EQ(other.status, 3);
  EXPECT_EQ(other.errors, "windhover-x: error: the hub is gone\n");
}

// Runs in the child of a death test, whose stderr is captured already.
void EndedBySignal() {
  std::string words[] = {"windhover-x", "s.yaml", "--lcm-url=memq://"};
  char* argv[] = {words[0].data(), words[1].data(), words[2].data()};
  std::exit(RunProcess("windhover-x", "does x", 3, argv, [](const ProcessArgs&) {
    if (StopRequested()) std::abort();
    raise(SIGTERM);
    if (!StopRequested()) std::abort();
  }));
}

TEST(RunProcess, SignalsAskToStop) {
  EXPECT_EXIT(EndedBySignal(), testing::ExitedWithCode(130), "");
}

TEST(ProcessShare, SharesCoverEveryAircraftOnce) {
  for (int count = 1; count <= 4; ++count) {
    for (int position = 0; position < 12; ++position) {
      int n_owners = 0;
      for (int index = 0; index < count; ++index) {
        n_owners += ProcessShare{.index = index, .count = count}.Owns(position) ? 1 : 0;
      }
      EXPECT_EQ(n_owners, 1);
    }
  }
}

TEST(StageTimer, AddsUpCallsInOrderOfFirstUse) {
  StageTimer timer;
  for (int i = 0; i < 3; ++i) {
    const StageTimer::Scope outer = timer.Start("tick");
    const StageTimer::Scope inner = timer.Start("render");
    // Work that takes CPU time for certain: until the clock has moved.
    for (const std::clock_t start = std::clock(); std::clock() < start + CLOCKS_PER_SEC / 500;) {
    }
  }
  ASSERT_EQ(timer.Stages().size(), 2u);
  EXPECT_EQ(timer.Stages()[0].name, "tick");
  EXPECT_EQ(timer.Stages()[1].name, "render");
  for (const StageTimer::Stage& stage : timer.Stages()) {
    EXPECT_EQ(stage.n, 3);
    EXPECT_GE(stage.cpu_ms, 3 * 1.9);   // 3 times 2 ms of work; clock() ticks in microseconds
    EXPECT_GE(stage.wall_ms, 3 * 1.9);  // one thread cannot work longer than it takes
  }
  EXPECT_GE(timer.Stages()[0].wall_ms, timer.Stages()[1].wall_ms);
}

// The kernel is not asked at each of them, but they count.
TEST(StageTimer, CountsTheCpuTimeOfShortCallsToo) {
  StageTimer timer;
  volatile double sum = 0;
  for (int i = 0; i < 100; ++i) {
    const StageTimer::Scope scope = timer.Start("short");
    for (int k = 0; k < 1000; ++k) sum = sum + k;
  }
  const StageTimer::Stage& stage = timer.Stages()[0];
  EXPECT_EQ(stage.n, 100);
  EXPECT_GT(stage.measured_cpu_ms, 0);
  EXPECT_GT(stage.cpu_ms, stage.measured_cpu_ms);
}

}  // namespace
}  // namespace windhover
