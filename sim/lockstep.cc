#include "sim/lockstep.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/bus/channels.h"
#include "common/bus/message_types.h"
#include "common/process/process.h"

namespace windhover {
namespace {

constexpr int kPoll_ms = 50;

bool IsControl(const std::string& channel) {
  return channel == channel::kTick || channel == channel::kTickDone || channel == channel::kHello ||
         channel.starts_with(channel::Status(""));
}

// Data flows from render to estimator to swarm: of several silent peers, the first holds up the
// others.
int UpstreamRank(const std::string& process) {
  constexpr std::array<std::string_view, 3> kOrder = {"render", "estimator", "swarm"};
  const auto found = std::find_if(kOrder.begin(), kOrder.end(),
                                  [&](std::string_view kind) { return process.starts_with(kind); });
  return static_cast<int>(found - kOrder.begin());
}

}  // namespace

RunInvalid::RunInvalid(std::string its_culprit, std::string its_reason)
    : std::runtime_error(its_culprit.empty() ? its_reason
                                             : fmt::format("{}: {}", its_culprit, its_reason)),
      culprit(std::move(its_culprit)),
      reason(std::move(its_reason)) {}

Lockstep::Lockstep(Bus& bus, std::int64_t run_id, std::vector<std::string> peers, double deadline_s)
    : bus_(bus),
      run_id_(run_id),
      peers_(std::move(peers)),
      deadline_s_(deadline_s),
      rehearsal_deadline_s_(deadline_s) {
  std::stable_sort(peers_.begin(), peers_.end(),
                   [](const auto& a, const auto& b) { return UpstreamRank(a) < UpstreamRank(b); });
  tick_.utime = std::numeric_limits<std::int64_t>::min();
  bus_.Subscribe<tick_t>(channel::kTick, [this](const tick_t& tick) { OnTick(tick); });
  bus_.Subscribe<hello_t>(channel::kHello, [this](const hello_t& hello) { OnHello(hello); });
  bus_.Subscribe<tick_done_t>(channel::kTickDone,
                              [this](const tick_done_t& done) { OnDone(done); });
  for (const std::string& peer : peers_) {
    bus_.Subscribe<status_t>(channel::Status(peer),
                             [this, peer](const status_t& status) { status_[peer] = status; });
  }
  EndTick();
}

// Who subscribes next has missed nothing yet.
void Lockstep::Watch() {
  const std::vector<std::string>& all = bus_.Subscriptions();
  for (; n_subscriptions_ < all.size(); ++n_subscriptions_) {
    const std::string& channel = all[n_subscriptions_];
    if (IsControl(channel)) continue;
    Watched& watched = watched_.emplace_back();
    watched.channel = channel;
    watched.count = &bus_.CountOf(channel);
  }
}

void Lockstep::EndTick() {
  Watch();
  for (Watched& watched : watched_) watched.before = *watched.count;
}

void Lockstep::OnTick(const tick_t& tick) {
  if (tick.run_id == run_id_) return;
  throw RunInvalid("", fmt::format("a TICK of run {} came: another simulator is running on this "
                                   "bus; give each its own --lcm-url",
                                   tick.run_id));
}

void Lockstep::OnHello(const hello_t& hello) {
  if (std::find(peers_.begin(), peers_.end(), hello.process) == peers_.end()) return;
  if (hello.run_id != 0 && hello.run_id != run_id_) {
    throw RunInvalid(hello.process, fmt::format("belongs to run {}; two runs share this bus, give "
                                                "each its own --lcm-url",
                                                hello.run_id));
  }
  CheckTypes(hello);
  present_.insert(hello.process);
}

void Lockstep::CheckTypes(const hello_t& hello) const {
  std::map<std::string, std::int64_t> ours;
  for (const type_fingerprint_t& type : AllFingerprints()) ours[type.name] = type.fingerprint;
  for (const type_fingerprint_t& type : hello.types) {
    const auto found = ours.find(type.name);
    if (found == ours.end() || found->second == type.fingerprint) continue;
    std::vector<std::string> channels;
    for (const std::string& channel : hello.subscriptions) {
      if (TypeOnChannel(channel) == type.name) channels.push_back(channel);
    }
    throw RunInvalid(
        hello.process,
        fmt::format(
            "was built with another {} ({}): its fingerprint is {:#018x}, the sim's "
            "{:#018x}; rebuild it with this lcmtypes/{}.lcm",
            type.name,
            channels.empty() ? "no subscription" : fmt::format("{}", fmt::join(channels, ", ")),
            static_cast<std::uint64_t>(type.fingerprint), static_cast<std::uint64_t>(found->second),
            type.name));
  }
}

void Lockstep::OnDone(const tick_done_t& done) {
  if (std::find(peers_.begin(), peers_.end(), done.process) == peers_.end()) return;
  if (done.run_id != run_id_ || done.utime != tick_.utime) {
    throw RunInvalid(done.process, fmt::format("answered tick {} of run {}, but this is tick {} of "
                                               "run {}",
                                               done.tick, done.run_id, tick_.tick, run_id_));
  }
  if (!done_.insert(done.process).second) {
    throw RunInvalid(done.process, fmt::format("answered tick {} twice: there are two processes of "
                                               "this name",
                                               done.tick));
  }
  for (const channel_count_t& count : done.channels) {
    const auto watched = std::find_if(watched_.begin(), watched_.end(), [&](const Watched& entry) {
      return entry.channel == count.channel;
    });
    if (watched == watched_.end()) continue;
    watched->n_announced += count.n_sent;
    if (!watched->is_announced || done.process < watched->announced_by) {
      watched->announced_by = done.process;
    }
    watched->is_announced = true;
  }
}

void Lockstep::Publish(tick_t tick) {
  tick.run_id = run_id_;
  bus_.Publish(channel::kTick, tick);
}

bool Lockstep::WaitUntil(Clock::time_point deadline, const std::function<bool()>& done) {
  // In one process everything that will come is already there, and nobody is late.
  while (bus_.InProcess() && !StopRequested() && bus_.Handle(0)) check_();
  while (!done()) {
    if (bus_.InProcess() || StopRequested()) return false;
    bus_.Handle(kPoll_ms);
    if (Clock::now() >= deadline) return done();
    check_();
  }
  return true;
}

void Lockstep::WaitForPeers(double timeout_s) {
  rehearsal_deadline_s_ = std::max(deadline_s_, timeout_s);
  const auto all_present = [this] { return present_.size() == peers_.size(); };
  const auto seconds = [](double t_s) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(t_s));
  };
  const auto deadline = Clock::now() + seconds(timeout_s);
  bool complete = all_present();
  while (!complete) {
    tick_t roll_call{};
    roll_call.phase = tick_t::PHASE_ROLL_CALL;
    Publish(roll_call);
    complete = WaitUntil(std::min(deadline, Clock::now() + seconds(0.25)), all_present);
    if (!complete && (bus_.InProcess() || StopRequested() || Clock::now() >= deadline)) {
      FailSilent(fmt::format("has not said HELLO within {} s", timeout_s), present_);
    }
  }
  EndTick();
}

void Lockstep::FailSilent(const std::string& what, const std::set<std::string>& heard) const {
  if (StopRequested()) throw RunInvalid("", "interrupted");
  std::vector<std::string> silent;
  for (const std::string& peer : peers_) {
    if (!heard.contains(peer)) silent.push_back(peer);
  }
  const std::string culprit = silent.front();
  silent.erase(silent.begin());
  throw RunInvalid(culprit, silent.empty()
                                ? what
                                : fmt::format("{}; neither have {}, which may wait for it", what,
                                              fmt::join(silent, ", ")));
}

bool Lockstep::AllArrived() const {
  return std::all_of(watched_.begin(), watched_.end(), [](const Watched& watched) {
    return watched.Received() == watched.Expected();
  });
}

void Lockstep::FailMissing() const {
  if (StopRequested()) throw RunInvalid("", "interrupted");
  for (const Watched& watched : watched_) {
    if (watched.Received() == watched.Expected()) continue;
    throw RunInvalid(
        watched.announced_by,
        fmt::format("tick {}: {} message(s) were sent on {} by this run, {} arrived", tick_.tick,
                    watched.Expected(), watched.channel, watched.Received()));
  }
  throw RunInvalid("", "no message is missing");  // Not reached: the caller found one.
}

void Lockstep::Step(tick_t tick) {
  if (tick.utime <= tick_.utime) {
    throw std::logic_error(fmt::format("tick {} is not later than tick {}", tick.tick, tick_.tick));
  }
  tick_ = tick;
  done_.clear();
  Watch();
  for (Watched& watched : watched_) {
    watched.is_announced = false;
    watched.n_announced = 0;
    watched.announced_by.clear();
  }
  Publish(tick);
  const double limit_s =
      tick.phase == tick_t::PHASE_REHEARSAL ? rehearsal_deadline_s_ : deadline_s_;
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(limit_s));
  if (!WaitUntil(deadline, [this] { return AllDone(); })) {
    FailSilent(fmt::format("has not answered tick {} within {} s", tick.tick, limit_s), done_);
  }
  if (!WaitUntil(deadline, [this] { return AllArrived(); })) FailMissing();
  EndTick();
}

std::vector<status_t> Lockstep::End(double timeout_s) {
  tick_t end = tick_;
  end.phase = tick_t::PHASE_END;
  Publish(end);
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<double>(timeout_s));
  WaitUntil(deadline, [this] { return status_.size() == peers_.size(); });
  std::vector<status_t> result;
  for (const std::string& peer : peers_) {
    if (const auto found = status_.find(peer); found != status_.end()) {
      result.push_back(found->second);
    }
  }
  return result;
}

}  // namespace windhover
