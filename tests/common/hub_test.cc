#include "common/bus/hub.h"

#include <array>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "common/bus/bus.h"
#include "common/bus/file_descriptor.h"
#include "common/bus/run_log.h"
#include "common/bus/tcpq_protocol.h"
#include "lcmtypes/image_t.hpp"
#include "lcmtypes/tick_t.hpp"
#include "tests/support/child_process.h"
#include "tests/support/hub_thread.h"

namespace windhover {
namespace {

using testing::HasSubstr;

// Handles until `done` or 20 s have passed.
void HandleUntil(Bus& bus, const std::function<bool()>& done) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!done() && std::chrono::steady_clock::now() < deadline) bus.Handle(50);
  ASSERT_TRUE(done());
}

tick_t TickNumber(int tick) {
  tick_t message{};
  message.tick = tick;
  return message;
}

std::string Word(std::uint32_t value) {
  const std::uint32_t word = htonl(value);
  return std::string(reinterpret_cast<const char*>(&word), 4);
}

// A client that speaks the protocol, or not, byte by byte.
class RawClient {
 public:
  explicit RawClient(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    EXPECT_EQ(connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  void Send(const std::string& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t n = send(socket_.get(), bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (n <= 0) return;  // The hub may have hung up on us.
      sent += static_cast<std::size_t>(n);
    }
  }
  void Greet() { Send(Word(tcpq::kClientMagic) + Word(tcpq::kVersion)); }
  // True if the hub hangs up, false if it stays silent for 20 s.
  bool HungUp() {
    const timeval timeout{.tv_sec = 20, .tv_usec = 0};
    setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof timeout);
    std::array<char, 4096> bytes;
    ssize_t n = 1;
    while (n > 0) n = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    return n == 0 || errno == ECONNRESET;
  }

 private:
  FileDescriptor socket_;
};

TEST(Hub, PassesEveryMessageInOrder) {
  HubThread hub;
  Bus sender(hub.Url());
  Bus receiver(hub.Url());
  std::vector<int> ticks;
  bool ready = false;
  receiver.Subscribe<tick_t>("TICK", [&](const tick_t& message) { ticks.push_back(message.tick); });
  // A message on the receiver's own connection comes back after its subscriptions took effect.
  receiver.Subscribe<tick_t>("READY", [&](const tick_t&) { ready = true; });
  receiver.Publish("READY", tick_t{});
  HandleUntil(receiver, [&] { return ready; });
  for (int i = 0; i < 2000; ++i) sender.Publish("TICK", TickNumber(i));
  HandleUntil(receiver, [&] { return ticks.size() == 2000; });
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(ticks[static_cast<std::size_t>(i)], i);

  const auto counts = nlohmann::json::parse(hub.Stop().CountsJson());
  EXPECT_EQ(counts["channels"]["TICK"]["in"], 2000);
  EXPECT_EQ(counts["channels"]["TICK"]["out"], 2000);
  EXPECT_TRUE(counts["dropped"].empty());
}

TEST(Hub, PassesImagesBothWaysAtOnceWithoutDeadlock) {
  HubThread hub;
  Bus a(hub.Url());
  Bus b(hub.Url());
  int n_a = 0;
  int n_b = 0;
  a.Subscribe<image_t>("TO_A", [&](const image_t&) { ++n_a; });
  b.Subscribe<image_t>("TO_B", [&](const image_t&) { ++n_b; });
  image_t image{};
  image.data.assign(5'529'600, 7);
  image.size = 5'529'600;
  // Both sides' sockets are full long before either reads.
  std::thread other([&] {
    for (int i = 0; i < 10; ++i) b.Publish("TO_A", image);
  });
  for (int i = 0; i < 10; ++i) a.Publish("TO_B", image);
  other.join();
  HandleUntil(a, [&] { return n_a == 10; });
  HandleUntil(b, [&] { return n_b == 10; });
}

TEST(Hub, SubscriptionsArePatternsForWholeNames) {
  HubThread hub;
  RawClient subscriber(hub.port());
  subscriber.Greet();
  for (const std::string pattern : {"TIC", "ICK", "T.C.", "(?!A)"}) {
    subscriber.Send(Word(tcpq::kSubscribe) + Word(static_cast<std::uint32_t>(pattern.size())) +
                    pattern);
  }
  const std::string all = "(?!A)";  // RE2 has no look-ahead: the hub sends everything.
  subscriber.Send(Word(tcpq::kUnsubscribe) + Word(static_cast<std::uint32_t>(all.size())) + all);
  // Published on the same connection, so after the subscriptions.
  for (const std::string name : {"TICK", "TICKS", "XTICK"}) {
    subscriber.Send(Word(tcpq::kPublish) + Word(static_cast<std::uint32_t>(name.size())) + name +
                    Word(0));
  }
  subscriber.Send(Word(99) + Word(1));  // Ends the connection.
  EXPECT_TRUE(subscriber.HungUp());
  const auto counts = nlohmann::json::parse(hub.Stop().CountsJson())["channels"];
  EXPECT_EQ(counts["TICK"]["out"], 1);
  EXPECT_EQ(counts["TICKS"]["out"], 0);
  EXPECT_EQ(counts["XTICK"]["out"], 0);
}

TEST(Hub, HangsUpOnWhoBreaksTheProtocol) {
  HubThread hub;
  const std::string hello = Word(tcpq::kClientMagic) + Word(tcpq::kVersion);
  const std::string publish = hello + Word(tcpq::kPublish);
  const std::vector<std::string> table = {
      "GET / HTTP/1.1\r\n\r\n",
      Word(tcpq::kServerMagic) + Word(tcpq::kVersion),
      hello + Word(0) + Word(4),                      // unknown type
      hello + Word(4) + Word(4),                      // unknown type
      publish + Word(0),                              // no channel
      publish + Word(64),                             // channel too long
      publish + Word(0xffffffff),                     // "
      publish + Word(1) + "A" + Word((1 << 28) + 1),  // data too long
      publish + Word(1) + "A" + Word(0xffffffff),     // "
      hello + Word(tcpq::kSubscribe) + Word(tcpq::kMaxPatternBytes + 1),
  };
  for (const std::string& bytes : table) {
    RawClient client(hub.port());
    client.Send(bytes);
    EXPECT_TRUE(client.HungUp());
  }
  EXPECT_NO_THROW(Bus(hub.Url()));
}

TEST(Hub, SurvivesGarbage) {
  HubThread hub;
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    RawClient client(hub.port());
    if (i % 3 > 0) client.Greet();
    std::string bytes;
    for (int n = 0; n < 50; ++n) {
      // Small words are likely to be types and lengths, so that some of it is understood.
      bytes += i % 3 == 2 ? Word(random() % 5) : Word(static_cast<std::uint32_t>(random()));
    }
    client.Send(bytes);
  }
  Bus bus(hub.Url());
  bool came = false;
  bus.Subscribe<tick_t>("TICK", [&](const tick_t&) { came = true; });
  bus.Publish("TICK", tick_t{});
  HandleUntil(bus, [&] { return came; });
}

TEST(Hub, DropsAPassiveClientThatStaysFullAndGoesOn) {
  HubThread hub({.port = 0, .queue_bytes = 1 << 20, .patience = std::chrono::milliseconds(200)});
  RawClient deaf(hub.port());  // Subscribes, and never reads.
  deaf.Greet();
  deaf.Send(Word(tcpq::kSubscribe) + Word(5) + "IMAGE");
  Bus bus(hub.Url());
  int n_came = 0;
  bus.Subscribe<image_t>("IMAGE", [&](const image_t&) { ++n_came; });
  image_t image{};
  image.data.assign(2'000'000, 7);
  image.size = 2'000'000;
  for (int i = 1; i <= 30; ++i) {
    bus.Publish("IMAGE", image);
    HandleUntil(bus, [&] { return n_came == i; });
  }
  const auto counts = nlohmann::json::parse(hub.Stop().CountsJson());
  ASSERT_EQ(counts["dropped"].size(), 1u);
  EXPECT_THAT(counts["dropped"][0].get<std::string>(), HasSubstr("pid"));
}

TEST(Hub, WaitsForAClientThatTakesPartInALockStep) {
  HubThread hub({.port = 0, .queue_bytes = 1 << 20, .patience = std::chrono::milliseconds(1)});
  Bus slow(hub.Url());
  int n_came = 0;
  bool ready = false;
  slow.Subscribe<image_t>("IMAGE", [&](const image_t&) {
    if (n_came++ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(300));
  });
  slow.Subscribe<tick_t>("TICK_DONE", [&](const tick_t&) { ready = true; });
  slow.Publish("TICK_DONE", tick_t{});
  HandleUntil(slow, [&] { return ready; });
  std::thread sender([&] {
    Bus bus(hub.Url());
    image_t image{};
    image.data.assign(2'000'000, 7);
    image.size = 2'000'000;
    for (int i = 0; i < 30; ++i) bus.Publish("IMAGE", image);
  });
  HandleUntil(slow, [&] { return n_came == 30; });
  sender.join();
  EXPECT_TRUE(nlohmann::json::parse(hub.Stop().CountsJson())["dropped"].empty());
}

TEST(Hub, WorksWithTheUnmodifiedLcmLogger) {
  const ChildProcess hub({std::string(WINDHOVER_BIN_DIR) + "/windhover-hub"});
  const std::string url = hub.ReadLine();
  ASSERT_THAT(url, HasSubstr("tcpq://127.0.0.1:"));
  const auto log = std::filesystem::path(testing::TempDir()) / "windhover_hub_test.lcm";
  std::filesystem::remove(log);
  ChildProcess logger({"lcm-logger", "--quiet", "--lcm-url=" + url, log.string()});
  Bus bus(url);
  // lcm-logger has subscribed once something is in its log.
  while (!std::filesystem::exists(log) || std::filesystem::file_size(log) == 0) {
    bus.Publish("WARM_UP", tick_t{});
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const auto before = std::filesystem::file_size(log);
  for (int i = 0; i < 1000; ++i) bus.Publish("TICK", TickNumber(i));
  // An event is 28 bytes, the channel and the message.
  const auto expected = before + 1000 * (28 + 4 + tick_t{}.getEncodedSize());
  for (int i = 0; i < 400 && std::filesystem::file_size(log) < expected; ++i) {
    bus.Publish("WARM_UP", tick_t{});  // lcm-logger flushes its file when the next event comes.
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_GE(std::filesystem::file_size(log), expected);
  hub.Signal(SIGTERM);
  const auto counts = nlohmann::json::parse(hub.ReadLine());
  EXPECT_EQ(counts["channels"]["TICK"]["in"], 1000);
  EXPECT_EQ(counts["channels"]["TICK"]["out"], 1000);
}

// LCM's own player reads the log and speaks to the hub: an oracle for both.
TEST(Hub, WorksWithTheUnmodifiedLcmLogplayer) {
  const auto file = std::filesystem::path(testing::TempDir()) / "windhover_hub_test_play.lcm";
  RunLogWriter log(file);
  for (int i = 0; i < 1000; ++i) log.Write("TICK", 10 * i, TickNumber(i));
  log.Flush();
  HubThread hub;
  Bus bus(hub.Url());
  std::vector<int> ticks;
  bool ready = false;
  bus.Subscribe<tick_t>("TICK", [&](const tick_t& message) { ticks.push_back(message.tick); });
  bus.Subscribe<tick_t>("READY", [&](const tick_t&) { ready = true; });
  bus.Publish("READY", tick_t{});
  HandleUntil(bus, [&] { return ready; });
  ChildProcess player({"lcm-logplayer", "--lcm-url=" + hub.Url(), file.string()});
  HandleUntil(bus, [&] { return ticks.size() == 1000; });
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(ticks[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(player.Wait(), 0);
}

TEST(TcpqBus, SaysWhatToDoWithoutAHub) {
  try {
    Bus bus("tcpq://127.0.0.1:1");
    FAIL() << "expected an error";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("start `windhover-hub"));
  }
}

TEST(TcpqBus, SaysThatTheHubIsGone) {
  auto hub = std::make_unique<HubThread>();
  Bus bus(hub->Url());
  hub.reset();
  for (int attempt = 0; attempt < 2; ++attempt) {
    try {
      bus.Handle(1000);
      FAIL() << "expected an error";
    } catch (const std::runtime_error& e) {
      EXPECT_THAT(e.what(), HasSubstr("is gone"));
    }
  }
}

}  // namespace
}  // namespace windhover
