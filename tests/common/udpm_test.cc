#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/bus/bus.h"
#include "common/bus/codec.h"
#include "common/bus/udp_network.h"
#include "lcmtypes/image_t.hpp"
#include "lcmtypes/tick_t.hpp"
#include "lcmtypes/tile_ack_t.hpp"
#include "lcmtypes/tile_t.hpp"
#include "tests/support/private_network.h"

namespace windhover {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// The buffer that a stock kernel grants: three datagrams of 60 kB.
const std::string kUrl = "udpm://239.255.76.67:7701?ttl=0&recv_buf_size=106496";
const std::string kTileUrl = "udpm://239.255.76.67:7702?ttl=0&recv_buf_size=106496";

void HandleUntil(Bus& bus, const std::function<bool()>& done) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!done() && std::chrono::steady_clock::now() < deadline) bus.Handle(50);
  ASSERT_TRUE(done());
}

image_t Pattern(int seed, int size) {
  image_t image{};
  image.utime = seed;
  image.size = size;
  image.data.resize(static_cast<std::size_t>(size));
  for (int i = 0; i < size; ++i) {
    image.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>((i * 31 + seed) >> 3);
  }
  return image;
}

TEST(UdpNetwork, CompletesUrls) {
  EXPECT_EQ(CompleteUdpmUrl("udpm://"), "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
  EXPECT_EQ(CompleteUdpmUrl("udpm://239.1.2.3:99?ttl=1"),
            "udpm://239.1.2.3:99?ttl=1&recv_buf_size=4194304");
  EXPECT_EQ(UdpmUrlOfNextPort("udpm://239.1.2.3:99?ttl=0"), "udpm://239.1.2.3:100?ttl=0");
  EXPECT_THROW(CompleteUdpmUrl("udpm://239.1.2.3:x"), std::runtime_error);
  EXPECT_THROW(CompleteUdpmUrl("udpm://239.1.2.3:65535"), std::runtime_error);
}

TEST(UdpmBus, SaysWhatToDoWithoutARoute) {
  if (!EnterPrivateNetwork(/*with_route=*/false)) GTEST_SKIP() << "no private network here";
  try {
    Bus bus(kUrl);
    FAIL() << "expected an error";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("ip route add 224.0.0.0/4 dev lo"), HasSubstr("tcpq")));
  }
}

class UdpmBusInAPrivateNetwork : public testing::Test {
 protected:
  void SetUp() override {
    if (!EnterPrivateNetwork(/*with_route=*/true)) GTEST_SKIP() << "no private network here";
  }
};

TEST_F(UdpmBusInAPrivateNetwork, SmallMessagesArrive) {
  Bus sender(kUrl);
  Bus receiver(kUrl);
  int n_came = 0;
  receiver.Subscribe<tick_t>("TICK", [&](const tick_t&) { ++n_came; });
  for (int i = 0; i < 100; ++i) {
    sender.Publish("TICK", tick_t{});
    HandleUntil(receiver, [&] { return n_came == i + 1; });
  }
  EXPECT_EQ(receiver.DroppedByKernel(), 0);
}

// At once, a frame needs 93 datagrams, and the buffer holds three.
TEST_F(UdpmBusInAPrivateNetwork, FramesArriveWholeAtEveryReaderThroughTheDefaultBuffer) {
  constexpr int kFrames = 20;
  constexpr int kFrameBytes = 5'529'600;
  std::atomic<int> n_ready{0};
  std::atomic<int> n_good{0};
  std::atomic<std::int64_t> n_dropped{0};
  const auto reader = [&] {
    Bus bus(kUrl);
    int n_came = 0;
    bus.Subscribe<image_t>("IMAGE", [&](const image_t& image) {
      n_good += image.data == Pattern(n_came, kFrameBytes).data && image.utime == n_came;
      ++n_came;
    });
    ++n_ready;
    HandleUntil(bus, [&] { return n_came == kFrames; });
    n_dropped = bus.DroppedByKernel();
  };
  std::thread first(reader);
  std::thread second(reader);
  Bus sender(kUrl);
  while (n_ready < 2) std::this_thread::yield();
  for (int i = 0; i < kFrames; ++i) sender.Publish("IMAGE", Pattern(i, kFrameBytes));
  first.join();
  second.join();
  EXPECT_EQ(n_good, 2 * kFrames);
  EXPECT_EQ(n_dropped, 0);
}

TEST_F(UdpmBusInAPrivateNetwork, SizesAroundATileArrive) {
  std::atomic<bool> ready{false};
  const std::vector<int> sizes = {59'900, 59'968, 59'969, 60'001, 119'968, 119'969, 120'001};
  std::vector<image_t> came;
  std::thread reader([&] {
    Bus bus(kUrl);
    bus.Subscribe<image_t>("IMAGE", [&](const image_t& image) { came.push_back(image); });
    ready = true;
    HandleUntil(bus, [&] { return came.size() == sizes.size(); });
  });
  Bus sender(kUrl);
  while (!ready) std::this_thread::yield();
  for (const int size : sizes) sender.Publish("IMAGE", Pattern(size, size));
  reader.join();
  ASSERT_EQ(came.size(), sizes.size());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    EXPECT_EQ(came[i].data, Pattern(sizes[i], sizes[i]).data);
  }
}

TEST_F(UdpmBusInAPrivateNetwork, SendsFramesFromInsideAHandler) {
  std::atomic<bool> ready{false};
  std::thread render([&] {
    Bus bus(kUrl);
    bool ticked = false;
    bus.Subscribe<tick_t>("TICK", [&](const tick_t&) {
      bus.Publish("IMAGE", Pattern(1, 1'000'000));
      ticked = true;
    });
    ready = true;
    HandleUntil(bus, [&] { return ticked; });
  });
  Bus sim(kUrl);
  bool came = false;
  sim.Subscribe<image_t>("IMAGE", [&](const image_t&) { came = true; });
  while (!ready) std::this_thread::yield();
  sim.Publish("TICK", tick_t{});
  HandleUntil(sim, [&] { return came; });
  render.join();
}

tile_t TileOf(std::int32_t message_bytes, std::int32_t index, std::int32_t n) {
  tile_t tile{};
  tile.sender = 1;
  tile.message_bytes = message_bytes;
  tile.tile = index;
  tile.n = n;
  tile.data.resize(static_cast<std::size_t>(n));
  return tile;
}

TEST_F(UdpmBusInAPrivateNetwork, TilesThatDoNotFitTheirMessageAreRejected) {
  Bus sender(kTileUrl);
  Bus receiver(kUrl);
  std::int64_t acknowledged = 0;
  sender.Subscribe<tile_ack_t>("TILE_ACK",
                               [&](const tile_ack_t& ack) { acknowledged = ack.message; });
  receiver.Subscribe<image_t>("IMAGE", [](const image_t&) { FAIL() << "must not arrive"; });
  const std::vector<std::pair<tile_t, bool>> table = {
      {TileOf(-1, 0, 10), true},          {TileOf(0, 0, 10), true},
      {TileOf(0x7fffffff, 0, 10), true},  {TileOf(100'000, 0, 10), true},
      {TileOf(100'000, 1, 50'000), true}, {TileOf(100'000, 0x7fffffff, 10), false},
      {TileOf(100'000, -1, 10), false},  // not missing, so ignored
  };
  int n = 0;
  for (auto [tile, is_error] : table) {
    tile.message = ++n;
    sender.Publish("TILE_IMAGE", tile);
    bool threw = false;
    const auto receive = [&] {
      try {
        receiver.Handle(10);
      } catch (const std::runtime_error&) {
        threw = true;
      }
      return threw || acknowledged == n;
    };
    HandleUntil(sender, receive);
    EXPECT_EQ(threw, is_error) << tile.message_bytes << " " << tile.tile << " " << tile.n;
  }
}

TEST_F(UdpmBusInAPrivateNetwork, DoubledTilesAreIgnored) {
  Bus sender(kTileUrl);
  Bus receiver(kUrl);
  int n_came = 0;
  bool ended = false;
  receiver.Subscribe<image_t>("IMAGE", [&](const image_t&) { ++n_came; });
  receiver.Subscribe<tick_t>("TICK", [&](const tick_t&) { ended = true; });
  tile_t tile{};
  tile.sender = 1;
  tile.data = Encode(Pattern(1, 100));
  tile.n = tile.message_bytes = static_cast<std::int32_t>(tile.data.size());
  for (int i = 0; i < 3; ++i) sender.Publish("TILE_IMAGE", tile);
  HandleUntil(receiver, [&] { return n_came > 0; });
  // Once another message is through, so would be a second delivery.
  Bus(kUrl).Publish("TICK", tick_t{});
  HandleUntil(receiver, [&] { return ended; });
  EXPECT_EQ(n_came, 1);
  EXPECT_EQ(receiver.Counts().at("IMAGE").received, 1);
}

}  // namespace
}  // namespace windhover
