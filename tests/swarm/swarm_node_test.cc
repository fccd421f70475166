#include "swarm/swarm_node.h"

#include <memory>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "lcmtypes/tick_done_t.hpp"

namespace windhover {
namespace {

using testing::Contains;
using testing::Not;

AircraftConfig Config() {
  AircraftConfig config;
  for (const int id : {0, 1, 4}) {
    AircraftSelf self;
    self.id = id;
    self.carries_rig = id != 1;
    self.controller = id == 1 ? Controller::kHold : Controller::kFollow;
    config.aircraft.push_back(self);
  }
  return config;
}

/// A node on an in-process bus, and a sim that feeds it.
class SwarmNodeTest : public testing::Test {
 protected:
  void Start(ProcessShare share) {
    node_ = std::make_unique<SwarmNode>(Config(), share, client_);
    subscriptions_ = bus_.Subscriptions();
    for (const int id : {0, 1, 4}) {
      bus_.Subscribe<velocity_command_t>(
          channel::VelocityCommand(id),
          [this](const velocity_command_t& command) { commands_.push_back(command); });
    }
    bus_.Subscribe<tick_done_t>(channel::kTickDone,
                                [this](const tick_done_t& done) { done_.push_back(done); });
  }

  // `target_m` 0: nobody is seen.
  void Tick(int k, std::int8_t phase, double target_m) {
    tick_t tick{};
    tick.utime = k * 100'000;
    tick.tick = k;
    tick.run_id = 5;
    tick.phase = phase;
    bus_.Publish(channel::kTick, tick);
    for (const int id : {0, 1, 4}) {
      nav_state_t nav{};
      nav.utime = tick.utime;
      nav.id = id;
      nav.qw = 1;
      bus_.Publish(channel::NavState(id), nav);
      range_t range{};
      range.utime = tick.utime;
      if (target_m > 0) {
        range_estimate_t estimate{};
        estimate.method = "baseline";
        estimate.p_RT_m[2] = estimate.range_m = target_m;
        range.estimates = {estimate};
        range.n_estimates = 1;
      }
      bus_.Publish(channel::Range(id), range);
    }
    while (bus_.Handle(0)) continue;
  }

  Bus bus_{"memq://"};
  TickClient client_{bus_, "swarm-0", 5};
  std::unique_ptr<SwarmNode> node_;
  std::vector<std::string> subscriptions_;
  std::vector<velocity_command_t> commands_;
  std::vector<tick_done_t> done_;
};

TEST_F(SwarmNodeTest, CommandsThoseThatFollow) {
  Start({0, 1});
  Tick(0, tick_t::PHASE_RUN, 15);
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_EQ(commands_[0].id, 0);
  EXPECT_EQ(commands_[1].id, 4);
  EXPECT_EQ(commands_[1].utime, 0);
  EXPECT_GT(commands_[0].v_WB_mps[0], 0);
  ASSERT_EQ(done_.size(), 1u);
  EXPECT_EQ(done_[0].n_channels, 2);
}

TEST_F(SwarmNodeTest, HearsOnlyWhatItsAircraftWould) {
  Start({0, 2});  // Positions 0 and 2: aircraft 0 and 4.
  EXPECT_THAT(subscriptions_, Contains("NAV_STATE_0"));
  EXPECT_THAT(subscriptions_, Contains("RANGE_4"));
  EXPECT_THAT(subscriptions_, Not(Contains("NAV_STATE_1")));
  EXPECT_THAT(subscriptions_, Not(Contains("RANGE_1")));
  EXPECT_THAT(subscriptions_, Not(Contains(testing::HasSubstr("TRUTH"))));
}

TEST_F(SwarmNodeTest, AnAircraftWithoutARigHasNoRanges) {
  Start({1, 2});
  EXPECT_THAT(subscriptions_, Contains("NAV_STATE_1"));
  EXPECT_THAT(subscriptions_, Not(Contains("RANGE_1")));
  Tick(0, tick_t::PHASE_RUN, 15);
  EXPECT_TRUE(commands_.empty());
  EXPECT_EQ(done_.size(), 1u);
}

// A target of the rehearsal must not be remembered.
TEST_F(SwarmNodeTest, RehearsalLeavesNoTrace) {
  Start({0, 1});
  Tick(-1, tick_t::PHASE_REHEARSAL, 500);
  ASSERT_EQ(commands_.size(), 2u);
  EXPECT_EQ(commands_[0].v_WB_mps[0], 0);
  commands_.clear();
  Tick(0, tick_t::PHASE_RUN, 0);
  EXPECT_EQ(commands_[0].v_WB_mps[0], 0);
}

}  // namespace
}  // namespace windhover
