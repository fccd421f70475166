#pragma once

#include <atomic>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "common/bus/hub.h"

namespace windhover {

/// A hub in a thread of the test.
class HubThread {
 public:
  explicit HubThread(const HubOptions& options = {})
      : hub_(options), thread_([this] { hub_.Run([this] { return stop_.load(); }); }) {}
  ~HubThread() { Stop(); }

  std::string Url() const { return fmt::format("tcpq://127.0.0.1:{}", hub_.port()); }
  std::uint16_t port() const { return hub_.port(); }

  /// Ends the hub; CountsJson() of it may be read then.
  const Hub& Stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return hub_;
  }

 private:
  Hub hub_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace windhover
