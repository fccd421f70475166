#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/bus/file_descriptor.h"

namespace re2 {
class RE2;
}

namespace windhover {

/// One message on its way through the hub; every receiver's queue shares the same bytes.
struct HubMessage {
  std::string channel;
  std::string header;  ///< What goes over the wire before the data.
  std::shared_ptr<std::uint8_t[]> data;
  std::size_t size = 0;

  std::size_t WireBytes() const { return header.size() + size; }
};

/// One connection of windhover-hub: takes tcpq apart as it arrives, in pieces of any size, and
/// queues what has to go out. Never blocks.
class HubClient {
 public:
  using Clock = std::chrono::steady_clock;

  HubClient(FileDescriptor socket, std::uint16_t port);
  ~HubClient();

  /// Reads what has arrived, a few MiB at most, and calls `on_message` for each published message.
  /// @returns empty, or why the connection cannot go on ("" is also the state after EOF: see
  /// Closed()).
  std::string Read(const std::function<void(std::shared_ptr<const HubMessage>)>& on_message);

  /// Whether it has subscribed to `channel`.
  bool Wants(const std::string& channel);

  void Queue(std::shared_ptr<const HubMessage> message);
  /// Sends as much as the socket takes now. False if the connection is broken.
  bool Flush();

  int socket() const { return socket_.get(); }
  std::uint16_t port() const { return port_; }
  std::size_t queued_bytes() const { return queued_bytes_; }
  bool Closed() const { return closed_; }
  /// It has published on HELLO, TICK or TICK_DONE: a run waits for it, however slow.
  bool TakesPart() const { return takes_part_; }

  // Kept by the hub.
  bool paused = false;             ///< Not read from, because a receiver of its messages is full.
  std::uint32_t watched = 0;       ///< epoll events asked for.
  Clock::time_point full_since{};  ///< Start of being full; the epoch when it is not.

 private:
  enum class Field { kHello, kHead, kName, kSize, kData };

  void Expect(Field field, std::size_t n_bytes);
  void Consume(const std::uint8_t* bytes, std::size_t n_bytes);
  void OnField();
  void OnHead();
  void OnName();
  void StartData(std::size_t size);
  void Publish();
  void Subscribe(const std::string& pattern);
  void Unsubscribe(const std::string& pattern);
  std::uint32_t Word(std::size_t offset) const;

  FileDescriptor socket_;
  std::uint16_t port_;
  bool closed_ = false;
  bool takes_part_ = false;
  std::string error_;

  Field field_ = Field::kHello;
  std::vector<std::uint8_t> small_;  // The field being read, unless it is the data.
  std::size_t n_needed_ = 0;
  std::size_t n_have_ = 0;
  std::uint32_t type_ = 0;
  std::shared_ptr<HubMessage> message_;
  const std::function<void(std::shared_ptr<const HubMessage>)>* on_message_ = nullptr;

  std::vector<std::pair<std::string, std::unique_ptr<re2::RE2>>> patterns_;
  std::unordered_map<std::string, bool> wants_;

  std::deque<std::shared_ptr<const HubMessage>> queue_;
  std::size_t front_sent_ = 0;  // Bytes of the first message in the queue that are out.
  std::size_t queued_bytes_ = 0;
};

}  // namespace windhover
