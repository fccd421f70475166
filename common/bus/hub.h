#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/file_descriptor.h"
#include "common/bus/hub_client.h"

namespace windhover {

struct HubOptions {
  std::uint16_t port = 0;                            ///< On 127.0.0.1; 0: any that is free.
  std::size_t queue_bytes = std::size_t{256} << 20;  ///< Per client; beyond it the client is full.
  std::chrono::milliseconds patience{5000};          ///< How long a passive client may stay full.
};

/// A broker of LCM's tcpq protocol: passes every message to whoever has subscribed to it.
///
/// Nothing is ever dropped. Each client has its own queue; while one is full, those who publish
/// to it are not read from, so they wait in their own send(). A client that stays full and takes
/// no part in a run's lock-step (a viewer, a logger) is disconnected and named on stderr; one
/// that does is waited for: the run's deadline watches it. One thread serves all.
class Hub {
 public:
  /// @throws std::runtime_error if the port cannot be had.
  explicit Hub(const HubOptions& options);
  ~Hub();

  std::uint16_t port() const { return port_; }

  /// Serves until `stop` returns true (asked several times a second), then sends what is queued
  /// for up to 2 s.
  void Run(const std::function<bool()>& stop);

  /// One line: {"channels": {NAME: {"in": n, "out": n}}, "n_clients": n, "dropped": [who]}.
  std::string CountsJson() const;

 private:
  struct Count {
    std::int64_t in = 0;
    std::int64_t out = 0;
  };

  void Step(int timeout_ms);
  void Accept();
  void Serve(int socket, std::uint32_t events);
  void Route(HubClient& from, const std::shared_ptr<const HubMessage>& message);
  void FlushAll();
  void UpdateFull(HubClient& client);
  void DropFullOnes();
  void ResumePaused();
  void Watch(HubClient& client);
  void Close(int socket, const std::string& why);
  std::string NameOf(std::uint16_t port);
  bool IsFull(const HubClient& client) const;
  void Listen(bool on);

  HubOptions options_;
  FileDescriptor listener_;
  FileDescriptor epoll_;
  std::uint16_t port_ = 0;
  bool listening_ = false;
  std::map<int, std::unique_ptr<HubClient>> clients_;  // By socket.
  std::map<std::string, Count> counts_;
  std::int64_t n_clients_ = 0;
  std::vector<std::string> dropped_;
  HubClient::Clock::time_point last_named_{};
  std::uint16_t last_named_port_ = 0;
};

}  // namespace windhover
