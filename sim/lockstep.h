#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.h"
#include "lcmtypes/hello_t.hpp"
#include "lcmtypes/status_t.hpp"
#include "lcmtypes/tick_done_t.hpp"
#include "lcmtypes/tick_t.hpp"

namespace windhover {

/// The run cannot go on or is not to be trusted.
class RunInvalid : public std::runtime_error {
 public:
  RunInvalid(std::string its_culprit, std::string its_reason);

  std::string culprit;  ///< The process to look at first; may be empty.
  std::string reason;
};

/// The sim's half of the lock-step (the peers' half is common/bus/tick_client.h): tells the peers
/// each tick and waits until all have answered and every message they counted has arrived.
///
/// On memq:// the peers live on the same bus, and waiting runs their handlers.
class Lockstep {
 public:
  /// `peers` are the processes that take part ("render-0"); `deadline_s` is wall-clock time for
  /// one tick of the run. Everything else that is to be recorded or read must be subscribed on
  /// `bus` before the first Step().
  Lockstep(Bus& bus, std::int64_t run_id, std::vector<std::string> peers, double deadline_s);
  Lockstep(const Lockstep&) = delete;

  /// `check` is called now and then while this waits; what it throws ends the wait.
  void CheckWhileWaiting(std::function<void()> check) { check_ = std::move(check); }

  /// Calls the roll until each peer has said HELLO. The rehearsal, in which peers do what is done
  /// only once, may take `timeout_s` too.
  /// @throws RunInvalid naming who is missing, or a peer with other message types.
  void WaitForPeers(double timeout_s);

  /// Publishes `tick` with this run's id and returns when it is done. What the sim itself says in
  /// this tick is published before.
  /// @pre tick.utime grows from call to call, the rehearsal's being the least.
  /// @throws RunInvalid naming the first silent peer in the order render, estimator, swarm, or
  /// the channel on which a message is missing or has come from outside the run.
  void Step(tick_t tick);

  /// Ends the run: PHASE_END, then the STATUS of each peer that sends one within `timeout_s`.
  std::vector<status_t> End(double timeout_s = 5);

 private:
  using Clock = std::chrono::steady_clock;

  /// A channel on which messages are waited for.
  struct Watched {
    std::int64_t Received() const { return count->received - before.received; }
    /// Peers announce what they have sent; what nobody announced, the sim itself has sent.
    std::int64_t Expected() const { return is_announced ? n_announced : count->sent - before.sent; }

    std::string channel;
    const ChannelCount* count;
    ChannelCount before;  ///< When the last tick ended.
    bool is_announced = false;
    std::int64_t n_announced = 0;  ///< In this tick.
    std::string announced_by;      ///< First of them, by name.
  };

  void OnHello(const hello_t& hello);
  void OnDone(const tick_done_t& done);
  void OnTick(const tick_t& tick);
  void CheckTypes(const hello_t& hello) const;
  void Publish(tick_t tick);
  bool WaitUntil(Clock::time_point deadline, const std::function<bool()>& done);
  bool AllDone() const { return done_.size() == peers_.size(); }
  bool AllArrived() const;
  void Watch();
  void EndTick();
  [[noreturn]] void FailSilent(const std::string& what, const std::set<std::string>& heard) const;
  [[noreturn]] void FailMissing() const;

  Bus& bus_;
  std::int64_t run_id_;
  std::vector<std::string> peers_;  // Upstream first.
  double deadline_s_;
  double rehearsal_deadline_s_;
  std::function<void()> check_ = [] {};
  tick_t tick_{};
  std::set<std::string> present_;
  std::set<std::string> done_;
  std::vector<Watched> watched_;     // In order of subscription.
  std::size_t n_subscriptions_ = 0;  // Of the bus, when last looked at.
  std::map<std::string, status_t> status_;
};

}  // namespace windhover
