#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/codec.h"
#include "lcmtypes/tile_ack_t.hpp"
#include "lcmtypes/tile_reader_t.hpp"
#include "lcmtypes/tile_t.hpp"

struct _lcm_t;
struct _lcm_recv_buf_t;

namespace windhover {

/// Large messages over udpm without loss.
///
/// Loopback multicast gives no back-pressure: a frame of 5.5 MB sent at once overruns every
/// receive buffer that a stock kernel grants, each time again. So it goes out in tiles of one
/// datagram, never more than two of them unacknowledged by any reader; two fit the default
/// buffer. A tile that is not acknowledged in time is sent again; readers ignore doubles.
///
/// All of this has its own LCM instance, one port above the bus: tiles cannot push small messages
/// out of a buffer, and tiles are received and acknowledged also while a message is being sent,
/// from inside a handler or not.
class UdpTiles {
 public:
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  /// `url` is that of the bus.
  explicit UdpTiles(const std::string& url);
  ~UdpTiles();
  UdpTiles(const UdpTiles&) = delete;

  static bool NeedsTiles(std::size_t n_bytes);

  /// Returns when every reader that is known has the whole message.
  /// @throws std::runtime_error naming the reader that does not acknowledge.
  void Publish(const std::string& channel, MessageBytes bytes);

  /// Takes part in `channel` as a reader that is waited for.
  void Subscribe(const std::string& channel);

  /// Readable when Receive() has something to do.
  int Socket() const;
  /// Takes in what has arrived; announces this reader every now and then.
  /// @throws std::runtime_error if something malformed came.
  void Receive();
  /// The oldest whole message that has not been taken yet.
  std::optional<Message> Take();

 private:
  using Clock = std::chrono::steady_clock;

  struct Input {
    UdpTiles* tiles;
    std::string channel;
  };
  struct Incoming {
    std::int64_t message = -1;  // The newest message of this sender on this channel.
    std::vector<std::uint8_t> bytes;
    std::set<std::int32_t> missing;
  };
  struct Outgoing;

  static void OnTileBytes(const _lcm_recv_buf_t* buffer, const char* channel, void* user) noexcept;
  static void OnAckBytes(const _lcm_recv_buf_t* buffer, const char* channel, void* user) noexcept;
  static void OnReaderBytes(const _lcm_recv_buf_t* buffer, const char* channel,
                            void* user) noexcept;

  void OnTile(const std::string& channel, const tile_t& tile);
  void OnAck(const tile_ack_t& ack);
  void OnReader(const tile_reader_t& reader);
  void Announce(const std::string& channel);
  void AnnounceNowAndThen();
  void AskForReaders(const std::string& channel);
  bool WaitUntil(Clock::time_point until);
  void SendTile(const std::string& channel, MessageBytes bytes, std::int32_t tile);
  void Acknowledge(const tile_t& tile);

  void CheckedPublish(const std::string& channel, const std::vector<std::uint8_t>& bytes);

  std::unique_ptr<_lcm_t, void (*)(_lcm_t*)> lcm_;
  std::int64_t self_;
  std::vector<std::unique_ptr<Input>> inputs_;
  std::map<std::pair<std::string, std::int64_t>, Incoming> incoming_;    // By channel and sender.
  std::map<std::string, std::map<std::int64_t, std::int32_t>> readers_;  // [channel][reader] = pid
  std::set<std::string> asked_;
  std::unique_ptr<Outgoing> outgoing_;
  std::int64_t n_messages_ = 0;
  Clock::time_point last_announced_{};
  std::deque<Message> ready_;
  std::exception_ptr error_;
};

}  // namespace windhover
