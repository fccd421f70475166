#include "common/bus/tick_client.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "lcmtypes/hello_t.hpp"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/status_t.hpp"
#include "lcmtypes/tick_done_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"

namespace windhover {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kRun = 77;

// A client that needs RANGE_3 and NAV_STATE_3 and answers with one command.
class TickClientTest : public testing::Test {
 protected:
  TickClientTest() {
    client_.Require("RANGE_3", &range_);
    client_.Require("NAV_STATE_3", &nav_);
    client_.OnTick([this](const tick_t& tick) {
      ticks_.push_back(tick.tick);
      seen_.push_back({range_.utime, nav_.utime});
      velocity_command_t command{};
      command.utime = tick.utime;
      client_.Publish("VELOCITY_COMMAND_3", command);
    });
    bus_.Subscribe<tick_done_t>(channel::kTickDone,
                                [this](const tick_done_t& done) { done_.push_back(done); });
  }

  void PublishTick(int tick, std::int8_t phase = tick_t::PHASE_RUN, std::int64_t run = kRun) {
    tick_t message{};
    message.utime = tick * 50'000;
    message.run_id = run;
    message.tick = tick;
    message.phase = phase;
    bus_.Publish(channel::kTick, message);
  }
  void PublishRange(int tick) {
    range_t message{};
    message.utime = tick * 50'000;
    bus_.Publish("RANGE_3", message);
  }
  void PublishNav(int tick) {
    nav_state_t message{};
    message.utime = tick * 50'000;
    bus_.Publish("NAV_STATE_3", message);
  }
  void Pump() {
    while (bus_.Handle(0)) continue;
  }

  Bus bus_{"memq://"};
  TickClient client_{bus_, "swarm-0", kRun};
  range_t range_{};
  nav_state_t nav_{};
  std::vector<int> ticks_;
  std::vector<std::pair<std::int64_t, std::int64_t>> seen_;
  std::vector<tick_done_t> done_;
};

TEST_F(TickClientTest, ProcessesOncePerTickInAnyOrderOfArrival) {
  std::vector<int> order = {0, 1, 2};
  int tick = 0;
  do {
    for (const int what : order) {
      if (what == 0) PublishTick(tick);
      if (what == 1) PublishRange(tick);
      if (what == 2) PublishNav(tick);
      Pump();
    }
    ASSERT_EQ(ticks_.size(), static_cast<std::size_t>(tick + 1));
    EXPECT_EQ(ticks_.back(), tick);
    EXPECT_EQ(seen_.back(), std::make_pair(tick * 50'000L, tick * 50'000L));
    ++tick;
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(tick, 6);
}

TEST_F(TickClientTest, AnswersWithWhatItPublished) {
  PublishNav(4);
  PublishRange(4);
  PublishTick(4);
  Pump();
  ASSERT_EQ(done_.size(), 1u);
  EXPECT_EQ(done_[0].process, "swarm-0");
  EXPECT_EQ(done_[0].tick, 4);
  EXPECT_EQ(done_[0].utime, 200'000);
  EXPECT_EQ(done_[0].run_id, kRun);
  ASSERT_EQ(done_[0].n_channels, 1);
  EXPECT_EQ(done_[0].channels[0].channel, "VELOCITY_COMMAND_3");
  EXPECT_EQ(done_[0].channels[0].n_sent, 1);
}

TEST_F(TickClientTest, IgnoresAndCountsStaleAndDoubledMessages) {
  PublishNav(1);
  PublishNav(1);  // doubled
  PublishRange(1);
  PublishTick(1);
  PublishTick(1);   // doubled
  PublishRange(0);  // stale
  PublishNav(1);    // stale
  Pump();
  EXPECT_EQ(ticks_, std::vector<int>{1});
  PublishRange(2);
  PublishTick(2);
  Pump();
  EXPECT_EQ(ticks_, std::vector<int>{1}) << "the stale NAV_STATE_3 must not complete tick 2";

  std::optional<status_t> status;
  bus_.Subscribe<status_t>("STATUS_swarm-0", [&](const status_t& message) { status = message; });
  PublishTick(3, tick_t::PHASE_END);
  Pump();
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->n_ignored, 4);
}

TEST_F(TickClientTest, EndsWithTheTimesOfItsStages) {
  for (int i = 0; i < 2; ++i) const StageTimer::Scope scope = client_.Timer().Start("control");
  std::optional<status_t> status;
  bus_.Subscribe<status_t>("STATUS_swarm-0", [&](const status_t& message) { status = message; });
  EXPECT_FALSE(client_.Ended());
  PublishTick(9, tick_t::PHASE_END);
  Pump();
  EXPECT_TRUE(client_.Ended());
  ASSERT_TRUE(status.has_value());
  ASSERT_EQ(status->n_stages, 1);
  EXPECT_EQ(status->stages[0].stage, "control");
  EXPECT_EQ(status->stages[0].n, 2);
  EXPECT_GT(status->peak_rss_mib, 0);
}

TEST_F(TickClientTest, ForeignRunIsExplained) {
  PublishTick(0, tick_t::PHASE_RUN, kRun + 1);
  try {
    Pump();
    FAIL() << "expected an error";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("another simulator is running on this bus"));
    EXPECT_THAT(e.what(), HasSubstr("78"));
  }
}

TEST_F(TickClientTest, SayingTheNextTickTooEarlyIsAnError) {
  PublishTick(0);
  PublishTick(1);
  EXPECT_THROW(Pump(), std::runtime_error);
}

TEST_F(TickClientTest, RollCallIsAnsweredByHelloWithSubscriptions) {
  std::optional<hello_t> hello;
  bus_.Subscribe<hello_t>(channel::kHello, [&](const hello_t& message) { hello = message; });
  PublishTick(0, tick_t::PHASE_ROLL_CALL);
  Pump();
  ASSERT_TRUE(hello.has_value());
  EXPECT_EQ(hello->process, "swarm-0");
  EXPECT_EQ(hello->run_id, kRun);
  EXPECT_THAT(hello->subscriptions, testing::IsSupersetOf({"TICK", "RANGE_3", "NAV_STATE_3"}));
  EXPECT_GT(hello->n_types, 20);
  EXPECT_TRUE(ticks_.empty());
}

TEST(TickClient, SeveralShareOneBus) {
  Bus bus("memq://");
  TickClient estimator(bus, "estimator-0", kRun);
  TickClient swarm(bus, "swarm-0", kRun);
  range_t range{};
  swarm.Require("RANGE_0", &range);
  std::vector<std::string> order;
  swarm.OnTick([&](const tick_t&) { order.emplace_back("swarm"); });
  estimator.OnTick([&](const tick_t& tick) {
    order.emplace_back("estimator");
    range_t message{};
    message.utime = tick.utime;
    estimator.Publish("RANGE_0", message);
  });
  tick_t tick{};
  tick.run_id = kRun;
  tick.phase = tick_t::PHASE_RUN;
  bus.Publish(channel::kTick, tick);
  while (bus.Handle(0)) continue;
  EXPECT_THAT(order, testing::ElementsAre("estimator", "swarm"));
}

}  // namespace
}  // namespace windhover
