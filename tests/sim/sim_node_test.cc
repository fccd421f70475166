#include "sim/sim_node.h"

#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "common/bus/run_log.h"
#include "common/bus/tick_client.h"
#include "common/bus/truth_channels.h"
#include "lcmtypes/run_end_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

Scenario FollowerAndLeader() {
  Scenario scenario;
  scenario.description = "test";
  scenario.duration_s = 1;
  scenario.frame_rate_hz = 10;
  scenario.nav.imu_rate_hz = 50;
  Aircraft follower, leader;
  follower.self.id = 0;
  follower.self.carries_rig = true;
  follower.self.controller = Controller::kFollow;
  leader.self.id = 1;
  leader.position_m = {10, 0, 0};
  scenario.aircraft = {follower, leader};
  return scenario;
}

/// A whole run on one in-process bus: peers that answer, and a swarm that sends `command`.
class SimNodeTest : public testing::Test {
 protected:
  struct Run {
    RunOutcome outcome;
    std::string log;
    std::vector<LogEvent> events;
  };

  Run Fly(const Scenario& scenario, const velocity_command_t& command, bool mute = false,
          Utime late = 0) {
    const auto file = folder_.path() / "run.lcm";
    Bus bus("memq://");
    std::vector<std::unique_ptr<TickClient>> peers;
    for (const std::string& name : PeersOf(scenario.execution)) {
      peers.push_back(std::make_unique<TickClient>(bus, name, 9));
      TickClient* const peer = peers.back().get();
      const bool commands = name == "swarm-0" && !mute;
      peer->OnTick([peer, commands, command, late](const tick_t& tick) {
        if (!commands) return;
        velocity_command_t now = command;
        now.utime = tick.utime - late;
        peer->Publish(channel::VelocityCommand(0), now);
      });
    }
    SimOptions options;
    options.run_id = 9;
    options.log_file = file;
    options.on_tick = [this](int tick, int n) { progress_.emplace_back(tick, n); };
    SimNode node(scenario, options, bus);
    Run run{node.Run(), "", {}};
    std::ifstream in(file, std::ios::binary);
    run.log.assign(std::istreambuf_iterator<char>(in), {});
    RunLogReader reader(file);
    while (auto event = reader.Next()) run.events.push_back(std::move(*event));
    return run;
  }

  static std::map<std::string, int> CountByChannel(const std::vector<LogEvent>& events) {
    std::map<std::string, int> counts;
    for (const LogEvent& event : events) ++counts[event.channel];
    return counts;
  }

  TemporaryFolder folder_;
  std::vector<std::pair<int, int>> progress_;
};

velocity_command_t Command(double east_mps) {
  velocity_command_t command{};
  command.v_WB_mps[0] = east_mps;
  return command;
}

TEST_F(SimNodeTest, RunsEveryTickAndLogsIt) {
  const Run run = Fly(FollowerAndLeader(), Command(1));
  EXPECT_TRUE(run.outcome.valid) << run.outcome.reason;
  EXPECT_EQ(run.outcome.n_ticks, 10);
  EXPECT_EQ(progress_.size(), 10u);
  EXPECT_EQ(progress_.back(), std::pair(9, 10));
  const auto counts = CountByChannel(run.events);
  EXPECT_EQ(counts.at("RUN_HEADER"), 1);
  EXPECT_EQ(counts.at("UAV_TRUTH"), 10);
  EXPECT_EQ(counts.at("NAV_STATE_1"), 10);
  EXPECT_EQ(counts.at("UWB_0"), 10);
  EXPECT_EQ(counts.at("VELOCITY_COMMAND_0"), 10);
  EXPECT_EQ(counts.at("IMU_0"), 46);  // 0 s to 0.9 s at 50 Hz, both ends
  EXPECT_EQ(run.events.back().channel, "RUN_END");
  EXPECT_EQ(Decode<run_end_t>(run.events.back().bytes).valid, 1);
}

TEST_F(SimNodeTest, AppliesCommandsUntilTheNextTick) {
  const Run run = Fly(FollowerAndLeader(), Command(1));
  std::vector<double> x_m;
  for (const LogEvent& event : run.events) {
    if (event.channel != channel::kUavTruth) continue;
    x_m.push_back(Decode<world_truth_t>(event.bytes).uavs[0].p_WB_m[0]);
  }
  EXPECT_EQ(x_m[0], 0);
  EXPECT_GT(x_m[1], 0);
  // ∫ 1 - (1 + 5 t) exp(-5 t) from 0 to 0.9 s.
  EXPECT_NEAR(x_m[9], 0.9 - 0.4 + (0.4 + 0.9) * std::exp(-4.5), 1e-6);
}

TEST_F(SimNodeTest, SameScenarioSameBytes) {
  const std::string one = Fly(FollowerAndLeader(), Command(1)).log;
  Scenario spread = FollowerAndLeader();
  spread.execution.swarm_processes = 2;
  EXPECT_GT(one.size(), 1000u);
  EXPECT_TRUE(one == Fly(FollowerAndLeader(), Command(1)).log);
  EXPECT_TRUE(one == Fly(spread, Command(1)).log);
  Scenario other_seed = FollowerAndLeader();
  other_seed.random_seed = 2;
  EXPECT_FALSE(one == Fly(other_seed, Command(1)).log);
}

TEST_F(SimNodeTest, ACommandThatIsNoNumberEndsTheRunAndNamesSwarm) {
  const Run run = Fly(FollowerAndLeader(), Command(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(run.outcome.valid);
  EXPECT_EQ(run.outcome.culprit, "swarm-0");
  EXPECT_THAT(run.outcome.reason, testing::HasSubstr("VELOCITY_COMMAND_0"));
  EXPECT_THAT(run.outcome.reason, testing::HasSubstr("nan"));
  const auto end = Decode<run_end_t>(run.events.back().bytes);
  EXPECT_EQ(end.valid, 0);
  EXPECT_THAT(end.reason, testing::StartsWith("swarm-0: "));
}

TEST_F(SimNodeTest, AMissingCommandEndsTheRun) {
  const Run run = Fly(FollowerAndLeader(), Command(1), /*mute=*/true);
  EXPECT_FALSE(run.outcome.valid);
  EXPECT_EQ(run.outcome.culprit, "swarm-0");
  EXPECT_THAT(run.outcome.reason, testing::HasSubstr("no command on VELOCITY_COMMAND_0"));
}

// The command of the tick before: it would fly on what was seen a tenth of a second ago.
TEST_F(SimNodeTest, ALateCommandEndsTheRun) {
  const Run run = Fly(FollowerAndLeader(), Command(1), /*mute=*/false, /*late=*/100'000);
  EXPECT_FALSE(run.outcome.valid);
  EXPECT_EQ(run.outcome.culprit, "swarm-0");
  EXPECT_EQ(run.outcome.reason,
            "tick 0: the command on VELOCITY_COMMAND_0 is of utime -100000, not 0");
  EXPECT_EQ(run.outcome.n_ticks, 0);
}

TEST_F(SimNodeTest, ACommandThatIsTooLargeEndsTheRun) {
  const Run run = Fly(FollowerAndLeader(), Command(101));
  EXPECT_FALSE(run.outcome.valid);
  EXPECT_EQ(run.outcome.culprit, "swarm-0");
  EXPECT_THAT(run.outcome.reason, testing::HasSubstr("at most 100 m/s"));
  EXPECT_THAT(run.outcome.reason, testing::HasSubstr("[101, 0, 0]"));
}

TEST_F(SimNodeTest, AbsentPeersEndTheRun) {
  Bus bus("memq://");
  SimOptions options;
  options.log_file = folder_.path() / "run.lcm";
  options.peers_timeout_s = 0;
  SimNode node(FollowerAndLeader(), options, bus);
  const RunOutcome outcome = node.Run();
  EXPECT_FALSE(outcome.valid);
  EXPECT_EQ(outcome.culprit, "render-0");
  EXPECT_EQ(outcome.n_ticks, 0);
}

TEST(SimProgram, WritesTheTruthOfOneInstant) {
  const TemporaryFolder folder;
  const auto scenario = folder.Write("s.yaml", R"(description: a path
random_seed: 1
duration_s: 4
aircraft:
  - {id: 0, carries_rig: true, position_m: [0, 0, 5]}
  - id: 1
    controller: waypoints
    waypoints: [{time_s: 0, position_m: [10, 0, 5]}, {time_s: 4, position_m: [14, 0, 5]}]
)");
  const std::string out = folder.path() / "truth";
  ChildProcess sim({WINDHOVER_BIN_DIR "/windhover-sim", scenario, "--truth-at", "2", "--out", out});
  EXPECT_EQ(sim.Wait(), 0);
  std::ifstream in(out, std::ios::binary);
  const std::vector<std::uint8_t> bytes(std::istreambuf_iterator<char>(in), {});
  const auto truth = Decode<world_truth_t>(bytes);
  EXPECT_EQ(truth.utime, 2'000'000);
  ASSERT_EQ(truth.n_uavs, 2);
  EXPECT_NEAR(truth.uavs[1].p_WB_m[0], 12, 1e-9);
}

}  // namespace
}  // namespace windhover
