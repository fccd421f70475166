#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/bus.h"
#include "lcmtypes/tick_t.hpp"

namespace windhover {

/// A peer's half of the lock-step (the other half is sim/lockstep.h).
///
/// For each tick the peer needs the TICK itself and one message of that tick on every required
/// channel, whatever their order of arrival; then `process` runs once, publishes what it has to
/// say, and TICK_DONE follows with the number of messages sent on each channel. Work never
/// depends on arrival order, so the same log comes out of any transport and any spread of
/// processes.
class TickClient {
 public:
  /// `process` is this process's name ("render-0"). Says HELLO until the first tick.
  TickClient(Bus& bus, std::string process);
  ~TickClient();
  TickClient(const TickClient&) = delete;

  /// Every tick needs one Message on `channel` with the tick's utime; `*latest` holds it when
  /// the tick is processed. Call before the first Handle().
  template <typename Message>
  void Require(const std::string& channel, Message* latest);

  /// Called once per tick (also the rehearsal), when all that is required has arrived.
  void OnTick(std::function<void(const tick_t&)> process);

  /// Publishes on the bus and counts the message into this tick's TICK_DONE.
  template <typename Message>
  void Publish(const std::string& channel, const Message& message);

  /// Repeats HELLO while no tick has come; call between Handle()s.
  void Announce();

  /// True after PHASE_END.
  bool Ended() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace windhover
