#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/codec.h"

namespace windhover {

/// What went over one channel, as this process saw it.
struct ChannelCount {
  std::int64_t sent = 0;
  std::int64_t received = 0;
  std::int64_t rejected = 0;  ///< Failed the bounded check; never reached a handler.
};

/// The one way processes talk: typed publish and subscribe over LCM.
///
/// A handler runs inside Handle(), on the caller's thread, so no process needs a lock. An
/// exception thrown by a handler comes out of Handle(); it never crosses LCM's C frames.
class Bus {
 public:
  /// `url` is an LCM provider: "tcpq://127.0.0.1:PORT" (windhover-hub), "udpm://…?ttl=0", or
  /// "memq://" inside one process.
  /// @throws std::runtime_error if it cannot be opened; says what to do about it.
  explicit Bus(const std::string& url);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Encodes and sends. Array members are checked against their counts first.
  /// @throws std::runtime_error naming the channel if it cannot be sent.
  template <typename Message>
  void Publish(const std::string& channel, const Message& message);

  /// `handler` is called with every well-formed Message on exactly `channel`. A malformed one is
  /// counted and makes Handle() throw with channel, type and reason. The memory of a message goes
  /// round: a handler must not call Handle().
  template <typename Message>
  void Subscribe(const std::string& channel, std::function<void(const Message&)> handler);

  /// @throws std::runtime_error if the message cannot be sent.
  void PublishBytes(const std::string& channel, MessageBytes bytes);
  /// `handler` gets the raw bytes of every message on exactly `channel`.
  void SubscribeBytes(const std::string& channel,
                      std::function<void(const std::string& channel, MessageBytes)> handler);

  /// Waits up to `timeout_ms` for a message and runs its handlers; true if one came.
  /// @throws what a handler threw; std::runtime_error if the bus is gone (the hub died).
  bool Handle(int timeout_ms);

  /// True on memq://, where nothing can arrive that has not been published already.
  bool InProcess() const;

  /// Datagrams that the kernel dropped at this process's sockets (udpm only, else 0).
  std::int64_t DroppedByKernel() const;

  /// Exact names of the channels subscribed to, in order of subscription.
  const std::vector<std::string>& Subscriptions() const;
  /// Of every channel on which something was sent or received.
  std::map<std::string, ChannelCount> Counts() const;
  /// Of one channel, now and as it goes on; lives as long as the bus.
  const ChannelCount& CountOf(const std::string& channel) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::vector<std::uint8_t> encoded_;
};

template <typename Message>
void Bus::Publish(const std::string& channel, const Message& message) {
  EncodeTo(message, &encoded_);
  PublishBytes(channel, encoded_);
}

template <typename Message>
void Bus::Subscribe(const std::string& channel, std::function<void(const Message&)> handler) {
  SubscribeBytes(channel, [handler = std::move(handler), message = std::make_shared<Message>()](
                              const std::string&, MessageBytes bytes) {
    DecodeTo(bytes, message.get());
    handler(*message);
  });
}

}  // namespace windhover
