#include "sim/lockstep.h"

#include <memory>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/channels.h"
#include "common/bus/tick_client.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"
#include "tests/support/hub_thread.h"

namespace windhover {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kRun = 5;

tick_t TickNumber(int k) {
  tick_t tick{};
  tick.tick = k;
  tick.utime = k * 50'000;
  tick.phase = k < 0 ? tick_t::PHASE_REHEARSAL : tick_t::PHASE_RUN;
  return tick;
}

RunInvalid InvalidFrom(const std::function<void()>& action) {
  try {
    action();
  } catch (const RunInvalid& e) {
    return e;
  }
  ADD_FAILURE() << "expected RunInvalid";
  return {"", ""};
}

// An estimator and a swarm process on the sim's own bus: NAV_STATE_0 -> RANGE_0 -> command.
class LockstepTest : public testing::Test {
 protected:
  LockstepTest() {
    estimator_.Require("NAV_STATE_0", &nav_);
    estimator_.OnTick([this](const tick_t& tick) {
      range_t range{};
      range.utime = tick.utime;
      if (estimator_works_) estimator_.Publish("RANGE_0", range);
    });
    swarm_.Require("RANGE_0", &range_);
    swarm_.OnTick([this](const tick_t& tick) {
      velocity_command_t command{};
      command.utime = tick.utime;
      swarm_.Publish("VELOCITY_COMMAND_0", command);
    });
    bus_.Subscribe<velocity_command_t>(
        "VELOCITY_COMMAND_0",
        [this](const velocity_command_t& command) { commands_.push_back(command.utime); });
  }

  void Step(int k) {
    nav_state_t nav{};
    nav.utime = TickNumber(k).utime;
    bus_.Publish("NAV_STATE_0", nav);
    lockstep_.Step(TickNumber(k));
  }

  Bus bus_{"memq://"};
  Lockstep lockstep_{bus_, kRun, {"swarm-0", "estimator-0"}, /*deadline_s=*/60};
  TickClient estimator_{bus_, "estimator-0", kRun};
  TickClient swarm_{bus_, "swarm-0", kRun};
  nav_state_t nav_{};
  range_t range_{};
  bool estimator_works_ = true;
  std::vector<std::int64_t> commands_;
};

TEST_F(LockstepTest, StepReturnsWhenEveryoneHasAnsweredThisTick) {
  lockstep_.WaitForPeers(60);
  for (int k = -1; k < 3; ++k) {
    Step(k);
    ASSERT_EQ(commands_.size(), static_cast<std::size_t>(k + 2));
    EXPECT_EQ(commands_.back(), k * 50'000);
  }
}

TEST_F(LockstepTest, EndCollectsTheStatusOfEachPeer) {
  lockstep_.WaitForPeers(60);
  Step(0);
  const std::vector<status_t> status = lockstep_.End();
  ASSERT_EQ(status.size(), 2u);
  EXPECT_EQ(status[0].process, "estimator-0");
  EXPECT_EQ(status[1].process, "swarm-0");
  EXPECT_TRUE(swarm_.Ended());
}

TEST_F(LockstepTest, NamesTheMostUpstreamSilentPeer) {
  lockstep_.WaitForPeers(60);
  const RunInvalid error = InvalidFrom([&] { lockstep_.Step(TickNumber(0)); });  // no NAV_STATE_0
  EXPECT_EQ(error.culprit, "estimator-0");
  EXPECT_THAT(error.reason, AllOf(HasSubstr("has not answered tick 0"), HasSubstr("swarm-0")));
}

TEST_F(LockstepTest, DownstreamPeerIsNamedWhenItAloneIsSilent) {
  lockstep_.WaitForPeers(60);
  estimator_works_ = false;
  EXPECT_EQ(InvalidFrom([&] { Step(0); }).culprit, "swarm-0");
}

TEST_F(LockstepTest, NamesWhoIsMissingAtTheStart) {
  Lockstep lockstep(bus_, kRun, {"estimator-0", "swarm-0", "render-0"}, 60);
  const RunInvalid error = InvalidFrom([&] { lockstep.WaitForPeers(60); });
  EXPECT_EQ(error.culprit, "render-0");
  EXPECT_THAT(error.reason, HasSubstr("HELLO"));
}

TEST_F(LockstepTest, TimeMustGrow) {
  lockstep_.WaitForPeers(60);
  Step(0);
  EXPECT_THROW(lockstep_.Step(TickNumber(0)), std::logic_error);
}

// A peer by hand, which answers what the test says.
class HandmadePeerTest : public testing::Test {
 protected:
  HandmadePeerTest() {
    bus_.Subscribe<range_t>("RANGE_0", [](const range_t&) {});
    bus_.Subscribe<tick_t>(channel::kTick, [this](const tick_t& tick) {
      if (tick.phase == tick_t::PHASE_ROLL_CALL) bus_.Publish(channel::kHello, hello_);
      if (tick.phase == tick_t::PHASE_RUN) Answer(tick);
    });
    hello_.process = "estimator-0";
    hello_.run_id = kRun;
  }

  void Answer(const tick_t& tick) {
    for (int i = 0; i < n_sent_; ++i) bus_.Publish("RANGE_0", range_t{});
    tick_done_t done{};
    done.utime = tick.utime;
    done.run_id = tick.run_id;
    done.process = "estimator-0";
    done.channels.resize(1);
    done.channels[0].channel = "RANGE_0";
    done.channels[0].n_sent = n_announced_;
    done.n_channels = 1;
    for (int i = 0; i < n_answers_; ++i) bus_.Publish(channel::kTickDone, done);
  }

  Bus bus_{"memq://"};
  Lockstep lockstep_{bus_, kRun, {"estimator-0"}, 60};
  hello_t hello_{};
  int n_sent_ = 1;
  int n_announced_ = 1;
  int n_answers_ = 1;
};

TEST_F(HandmadePeerTest, AcceptsWhatIsAnnouncedAndArrives) {
  lockstep_.WaitForPeers(60);
  for (int k = 0; k < 3; ++k) EXPECT_NO_THROW(lockstep_.Step(TickNumber(k)));
}

TEST_F(HandmadePeerTest, LostMessageIsNoticed) {
  lockstep_.WaitForPeers(60);
  n_announced_ = 2;
  const RunInvalid error = InvalidFrom([&] { lockstep_.Step(TickNumber(0)); });
  EXPECT_EQ(error.culprit, "estimator-0");
  EXPECT_THAT(error.reason, AllOf(HasSubstr("RANGE_0"), HasSubstr("2 message(s) were sent"),
                                  HasSubstr("1 arrived")));
}

TEST_F(HandmadePeerTest, MessageFromOutsideTheRunIsNoticed) {
  lockstep_.WaitForPeers(60);
  n_sent_ = 2;
  EXPECT_THAT(InvalidFrom([&] { lockstep_.Step(TickNumber(0)); }).reason,
              AllOf(HasSubstr("RANGE_0"), HasSubstr("2 arrived")));
}

TEST_F(HandmadePeerTest, TwoProcessesOfOneNameAreNoticed) {
  lockstep_.WaitForPeers(60);
  n_answers_ = 2;
  EXPECT_THAT(InvalidFrom([&] {
                lockstep_.Step(TickNumber(0));
                lockstep_.Step(TickNumber(1));
              }).culprit,
              "estimator-0");
}

TEST_F(HandmadePeerTest, OtherMessageTypesAreNamedWithChannelAndBothHashes) {
  type_fingerprint_t type{};
  type.name = "range_t";
  type.fingerprint = 0x1234;
  hello_.types = {type};
  hello_.n_types = 1;
  hello_.subscriptions = {"NAV_STATE_0", "RANGE_0"};
  hello_.n_subscriptions = 2;
  const RunInvalid error = InvalidFrom([&] { lockstep_.WaitForPeers(60); });
  EXPECT_EQ(error.culprit, "estimator-0");
  EXPECT_THAT(
      error.reason,
      AllOf(HasSubstr("range_t"), HasSubstr("RANGE_0"), HasSubstr("0x0000000000001234"),
            HasSubstr(fmt::format("{:#018x}", static_cast<std::uint64_t>(range_t::getHash())))));
}

TEST_F(HandmadePeerTest, PeerOfAnotherRunIsNoticed) {
  hello_.run_id = kRun + 1;
  EXPECT_THAT(InvalidFrom([&] { lockstep_.WaitForPeers(60); }).reason, HasSubstr("two runs"));
}

TEST_F(HandmadePeerTest, OtherSimulatorIsNoticed) {
  tick_t foreign = TickNumber(0);
  foreign.run_id = kRun + 1;
  bus_.Publish(channel::kTick, foreign);
  EXPECT_THAT(InvalidFrom([&] { lockstep_.WaitForPeers(60); }).reason,
              HasSubstr("another simulator"));
}

TEST(LockstepOverTheHub, KeepsStepWithPeersInTheirOwnThreads) {
  HubThread hub;
  const auto peer = [&](const std::string& name, const std::string& in, const std::string& out) {
    Bus bus(hub.Url());
    TickClient client(bus, name, kRun);
    range_t latest{};
    client.Require(in, &latest);
    client.OnTick([&](const tick_t& tick) {
      latest.utime = tick.utime;
      client.Publish(out, latest);
    });
    while (!client.Ended()) {
      client.Announce();
      bus.Handle(20);
    }
  };
  std::thread first(peer, "estimator-0", "RANGE_0", "RANGE_1");
  std::thread second(peer, "swarm-0", "RANGE_1", "RANGE_2");
  Bus bus(hub.Url());
  std::vector<std::int64_t> came;
  bus.Subscribe<range_t>("RANGE_2", [&](const range_t& range) { came.push_back(range.utime); });
  Lockstep lockstep(bus, kRun, {"estimator-0", "swarm-0"}, 60);
  lockstep.WaitForPeers(60);
  for (int k = 0; k < 200; ++k) {
    range_t range{};
    range.utime = TickNumber(k).utime;
    bus.Publish("RANGE_0", range);
    lockstep.Step(TickNumber(k));
    ASSERT_EQ(came.size(), static_cast<std::size_t>(k + 1));
    ASSERT_EQ(came.back(), range.utime);
  }
  EXPECT_EQ(lockstep.End().size(), 2u);
  first.join();
  second.join();
}

// What is done only once may take as long as the start of a process.
TEST(LockstepOverTheHub, HoldsTheRehearsalToNoDeadlineOfATick) {
  HubThread hub;
  std::thread peer([url = hub.Url()] {
    Bus bus(url);
    TickClient client(bus, "render-0", kRun);
    int n_ticks = 0;
    client.OnTick([&](const tick_t&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      ++n_ticks;
    });
    while (n_ticks < 2) {
      client.Announce();
      bus.Handle(20);
    }
  });
  Bus bus(hub.Url());
  Lockstep lockstep(bus, kRun, {"render-0"}, /*deadline_s=*/0.1);
  lockstep.WaitForPeers(60);
  EXPECT_NO_THROW(lockstep.Step(TickNumber(-1)));
  EXPECT_THAT(InvalidFrom([&] { lockstep.Step(TickNumber(0)); }).reason, HasSubstr("tick 0"));
  peer.join();
}

TEST(LockstepOverTheHub, NamesThePeerThatMissesTheDeadline) {
  HubThread hub;
  Bus bus(hub.Url());
  Bus peer_bus(hub.Url());
  TickClient peer(peer_bus, "render-0", kRun);
  range_t never{};
  peer.Require("RANGE_0", &never);
  Lockstep lockstep(bus, kRun, {"swarm-0", "render-0"}, /*deadline_s=*/0.05);
  const RunInvalid absent = InvalidFrom([&] { lockstep.WaitForPeers(0.05); });
  EXPECT_EQ(absent.culprit, "render-0");
  EXPECT_THAT(absent.reason, AllOf(HasSubstr("0.05 s"), HasSubstr("swarm-0")));
  const RunInvalid silent = InvalidFrom([&] { lockstep.Step(TickNumber(3)); });
  EXPECT_EQ(silent.culprit, "render-0");
  EXPECT_THAT(silent.reason, HasSubstr("tick 3"));
}

}  // namespace
}  // namespace windhover
