#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "common/bus/bus.h"
#include "common/process/stage_timer.h"
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
  /// `process` is this process's name ("render-0"); several may share one `bus`, which must
  /// outlive them. `run_id` 0: take part in whatever run is heard first. A TICK of any other run
  /// makes Handle() throw: two simulators share the bus.
  TickClient(Bus& bus, std::string process, std::int64_t run_id = 0);
  ~TickClient();
  TickClient(const TickClient&) = delete;

  /// Every tick needs one Message on `channel` with the tick's utime; `*latest` holds it while
  /// the tick is processed. A message of an earlier tick, or a second one of this tick, is
  /// ignored and counted. Call before the first Handle().
  template <typename Message>
  void Require(const std::string& channel, Message* latest);

  /// Called once per tick, when all that is required has arrived. For the rehearsal
  /// (PHASE_REHEARSAL) it publishes as ever but must leave no trace in any state.
  void OnTick(std::function<void(const tick_t&)> process);

  /// Publishes on the bus and counts the message into this tick's TICK_DONE.
  template <typename Message>
  void Publish(const std::string& channel, const Message& message);

  /// Says HELLO every now and then while no tick has come; call between Handle()s, after all
  /// subscriptions. A roll call of the sim is answered in any case.
  void Announce();

  /// Where the process's time goes; published in STATUS_<process> at PHASE_END.
  StageTimer& Timer();

  /// True after PHASE_END.
  bool Ended() const;

 private:
  struct Impl;

  // `hold` decodes a message, calls Accept with its utime and keeps it if true; `deliver` hands
  // over what is kept.
  void RequireBytes(const std::string& channel,
                    std::function<void(std::size_t requirement, MessageBytes)> hold,
                    std::function<void()> deliver);
  bool Accept(std::size_t requirement, std::int64_t utime);
  Bus& MyBus();
  void CountSent(const std::string& channel);

  std::unique_ptr<Impl> impl_;
};

template <typename Message>
void TickClient::Require(const std::string& channel, Message* latest) {
  // The memory of a message goes round: pixels are not allocated anew each tick.
  auto held = std::make_shared<Message>(), decoded = std::make_shared<Message>();
  RequireBytes(
      channel,
      [this, held, decoded](std::size_t requirement, MessageBytes bytes) {
        DecodeTo(bytes, decoded.get());
        if (Accept(requirement, decoded->utime)) std::swap(*held, *decoded);
      },
      [held, latest] { std::swap(*latest, *held); });
}

template <typename Message>
void TickClient::Publish(const std::string& channel, const Message& message) {
  MyBus().Publish(channel, message);
  CountSent(channel);
}

}  // namespace windhover
