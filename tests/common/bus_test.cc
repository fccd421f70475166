#include "common/bus/bus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"

namespace windhover {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

nav_state_t NavStateAt(std::int64_t utime) {
  nav_state_t state{};
  state.utime = utime;
  return state;
}

// What Handle() throws, or "" if it does not.
std::string HandleError(Bus& bus) {
  try {
    bus.Handle(1000);
    return "";
  } catch (const std::runtime_error& e) {
    return e.what();
  }
}

TEST(Bus, DeliversWhatWasPublished) {
  Bus bus("memq://");
  range_t received{};
  bus.Subscribe<range_t>("RANGE_0", [&](const range_t& message) { received = message; });
  range_t sent{};
  sent.utime = 1'500'000;
  sent.estimates.resize(1);
  sent.estimates[0].method = "baseline";
  sent.estimates[0].range_m = 12.5;
  sent.n_estimates = 1;
  bus.Publish("RANGE_0", sent);
  ASSERT_TRUE(bus.Handle(1000));
  EXPECT_EQ(received.utime, 1'500'000);
  ASSERT_EQ(received.estimates.size(), 1u);
  EXPECT_EQ(received.estimates[0].method, "baseline");
  EXPECT_EQ(received.estimates[0].range_m, 12.5);
}

TEST(Bus, HandleReturnsFalseWhenNothingCame) {
  Bus bus("memq://");
  EXPECT_FALSE(bus.Handle(0));
}

TEST(Bus, CountsAMessageOnceHoweverManyReadIt) {
  Bus bus("memq://");
  int n_handled = 0;
  for (int i = 0; i < 3; ++i) {
    bus.Subscribe<nav_state_t>("NAV_STATE_0", [&](const nav_state_t&) { ++n_handled; });
  }
  bus.Publish("NAV_STATE_0", NavStateAt(1));
  while (bus.Handle(0)) continue;
  EXPECT_EQ(n_handled, 3);
  EXPECT_EQ(bus.Counts().at("NAV_STATE_0").sent, 1);
  EXPECT_EQ(bus.Counts().at("NAV_STATE_0").received, 1);
  EXPECT_THAT(bus.Subscriptions(), ElementsAre("NAV_STATE_0"));
}

TEST(Bus, KeepsMoreMessagesThanLcmsDefaultQueue) {
  Bus bus("memq://");
  int n_handled = 0;
  bus.Subscribe<nav_state_t>("NAV_STATE_0", [&](const nav_state_t&) { ++n_handled; });
  for (int i = 0; i < 1000; ++i) bus.Publish("NAV_STATE_0", NavStateAt(i));
  while (bus.Handle(0)) continue;
  EXPECT_EQ(n_handled, 1000);
}

TEST(Bus, HandlersExceptionComesOutOfHandle) {
  Bus bus("memq://");
  bus.Subscribe<nav_state_t>("NAV_STATE_0",
                             [](const nav_state_t&) { throw std::runtime_error("boom"); });
  bus.Publish("NAV_STATE_0", NavStateAt(1));
  bus.Publish("NAV_STATE_0", NavStateAt(2));
  EXPECT_EQ(HandleError(bus), "boom");
  EXPECT_EQ(HandleError(bus), "boom");  // LCM is still usable after the first.
  EXPECT_FALSE(bus.Handle(0));
}

TEST(Bus, NamesChannelTypeAndReasonOfAMalformedMessage) {
  Bus bus("memq://");
  bool handled = false;
  bus.Subscribe<range_t>("RANGE_0", [&](const range_t&) { handled = true; });
  bus.Publish("RANGE_0", NavStateAt(1));
  EXPECT_THAT(
      HandleError(bus),
      AllOf(
          HasSubstr("RANGE_0"), HasSubstr("range_t"),
          HasSubstr(fmt::format("{:#018x}", static_cast<std::uint64_t>(range_t::getHash()))),
          HasSubstr(fmt::format("{:#018x}", static_cast<std::uint64_t>(nav_state_t::getHash())))));
  EXPECT_FALSE(handled);
  EXPECT_EQ(bus.Counts().at("RANGE_0").received, 1);
  EXPECT_EQ(bus.Counts().at("RANGE_0").rejected, 1);
}

TEST(Bus, RefusesToPublishACountThatIsNotTheVectorsSize) {
  Bus bus("memq://");
  range_t message{};
  message.n_estimates = 2;  // lcm-gen's encoder would read two estimates that are not there
  EXPECT_THROW(bus.Publish("RANGE_0", message), std::runtime_error);
  message.n_estimates = 0;
  message.estimates.resize(1);
  EXPECT_THROW(bus.Publish("RANGE_0", message), std::runtime_error);
  message.n_estimates = 1;
  EXPECT_NO_THROW(bus.Publish("RANGE_0", message));
}

TEST(Bus, RefusesChannelNamesThatLcmWouldTakeForPatterns) {
  Bus bus("memq://");
  for (const std::string name : {"", "RANGE_.*", "A B", "A.B"}) {
    EXPECT_THROW(bus.Publish(name, NavStateAt(1)), std::runtime_error) << name;
    EXPECT_THROW(bus.SubscribeBytes(name, {}), std::runtime_error) << name;
  }
  EXPECT_THROW(bus.Publish(std::string(64, 'A'), NavStateAt(1)), std::runtime_error);
  EXPECT_NO_THROW(bus.Publish(std::string(63, 'A'), NavStateAt(1)));
}

}  // namespace
}  // namespace windhover
