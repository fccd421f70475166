#include "cli/process_group.h"

#include <fstream>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string TextOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

ProcessSpec Shell(const std::string& name, const std::string& script, bool report_lines = false) {
  return {name, "/bin/sh", {"-c", script}, report_lines};
}

// Everything that happens until no process runs.
std::vector<ProcessEvent> RunToTheEnd(ProcessGroup& group) {
  std::vector<ProcessEvent> all;
  while (!group.Running().empty()) {
    for (ProcessEvent& event : group.Wait(milliseconds(1000))) all.push_back(event);
  }
  return all;
}

TEST(ProcessGroup, ReportsLinesThenTheEnd) {
  const TemporaryFolder folder;
  ProcessGroup group(folder.path() / "logs");
  group.Start(Shell("a", "echo one; echo two; echo oops >&2; exit 3", true));
  const auto events = RunToTheEnd(group);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[0].line, "one");
  EXPECT_EQ(events[1].line, "two");
  EXPECT_EQ(events[2].kind, ProcessEvent::Kind::kExit);
  EXPECT_EQ(DescribeExit(events[2].status), "ended with exit status 3");
  EXPECT_THAT(TextOf(folder.path() / "logs/a.log"), HasSubstr("oops"));
  EXPECT_THAT(TextOf(folder.path() / "logs/a.log"), HasSubstr("two"));
  EXPECT_GT(group.peak_rss_mib().at("a"), 0.1);  // A shell.
}

TEST(ProcessGroup, KnowsHowAProcessDied) {
  const TemporaryFolder folder;
  ProcessGroup group(folder.path());
  group.Start(Shell("a", "kill -9 $$"));
  const auto events = RunToTheEnd(group);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(DescribeExit(events[0].status), "was killed by signal 9 (Killed)");
}

TEST(ProcessGroup, FindsStoppedProcessesAndKillsThemToo) {
  const TemporaryFolder folder;
  ProcessGroup group(folder.path());
  group.Start(Shell("runs", "exec sleep 100"));
  group.Start(Shell("stops", "exec sleep 100"));
  EXPECT_THAT(group.Stopped(), IsEmpty());
  group.Signal("stops", SIGSTOP);
  while (group.Stopped().empty()) group.Wait(milliseconds(10));
  EXPECT_THAT(group.Stopped(), ElementsAre("stops"));
  group.KillAll();
  EXPECT_THAT(group.Running(), IsEmpty());
}

TEST(ProcessGroup, RefusesAProgramThatIsNotThere) {
  const TemporaryFolder folder;
  ProcessGroup group(folder.path());
  try {
    group.Start({"x", "/no/such/program", {}});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "/no/such/program: No such file or directory");
  }
}

TEST(ProcessGroup, ChildrenDieWithTheirParent) {
  const TemporaryFolder folder;
  const std::filesystem::path pid_file = folder.path() / "pid";
  const pid_t parent = fork();
  if (parent == 0) {
    ProcessGroup group(folder.path());
    group.Start(Shell("orphan", "echo $$ > " + pid_file.string() + ".part; mv " +
                                    pid_file.string() + ".part " + pid_file.string() +
                                    "; exec sleep 100"));
    pause();
    _exit(0);
  }
  while (!std::filesystem::exists(pid_file)) std::this_thread::sleep_for(milliseconds(5));
  const pid_t orphan = std::stoi(TextOf(pid_file));
  ASSERT_EQ(kill(orphan, 0), 0);
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  // Dead, or dead and waiting for init to take note: never running. The test's own time-out
  // ends this loop if it lives.
  const auto state = [&] {
    const std::string stat = TextOf("/proc/" + std::to_string(orphan) + "/stat");
    return stat.empty() ? 'X' : stat[stat.rfind(')') + 2];
  };
  while (state() != 'X' && state() != 'Z') std::this_thread::sleep_for(milliseconds(5));
}

}  // namespace
}  // namespace windhover
