#include "common/bus/tick_client.h"

#include <chrono>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>

#include "common/bus/channels.h"
#include "common/bus/message_types.h"
#include "common/bus/stage_status.h"
#include "lcmtypes/hello_t.hpp"
#include "lcmtypes/status_t.hpp"
#include "lcmtypes/tick_done_t.hpp"

namespace windhover {
namespace {

constexpr std::chrono::milliseconds kHelloPeriod{100};

double PeakMemory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts in KiB.
}

}  // namespace

struct TickClient::Impl {
  Impl(Bus& its_bus, std::string its_process, std::int64_t its_run_id)
      : bus(its_bus), process(std::move(its_process)), run_id(its_run_id) {}

  struct Requirement {
    std::string channel;
    std::optional<std::int64_t> held_utime;
    std::function<void()> deliver;
  };

  void OnTickMessage(const tick_t& message);
  void CheckRun(const tick_t& message);
  bool AllHeld() const;
  void ProcessIfComplete();
  void SayHello();
  void SayDone(const tick_t& done);
  void SayStatus();

  Bus& bus;
  std::string process;
  std::int64_t run_id;
  std::vector<Requirement> requirements;
  std::function<void(const tick_t&)> on_tick;
  std::optional<tick_t> tick;  // Waits for what it requires.
  std::int64_t last_utime = std::numeric_limits<std::int64_t>::min();  // Of the last tick done.
  std::map<std::string, std::int32_t> n_sent;  // In this tick; 0 of channels of earlier ones.
  tick_done_t answer{};                        // Whose memory goes round.
  std::int64_t n_ignored = 0;
  std::optional<std::chrono::steady_clock::time_point> last_hello;
  bool ticked = false;
  bool ended = false;
  StageTimer timer;
};

void TickClient::Impl::CheckRun(const tick_t& message) {
  if (run_id == 0) run_id = message.run_id;
  if (message.run_id == run_id) return;
  throw std::runtime_error(
      fmt::format("{}: a TICK of run {} came, but this is run {}: another simulator is running on "
                  "this bus; give each its own --lcm-url",
                  process, message.run_id, run_id));
}

void TickClient::Impl::OnTickMessage(const tick_t& message) {
  if (ended) return;
  CheckRun(message);
  if (message.phase == tick_t::PHASE_ROLL_CALL) {
    SayHello();
    return;
  }
  if (message.phase == tick_t::PHASE_END) {
    SayStatus();
    ended = true;
    return;
  }
  if (message.utime <= last_utime || (tick && tick->utime == message.utime)) {
    ++n_ignored;
    return;
  }
  if (tick) {
    throw std::runtime_error(fmt::format("{}: tick {} came before tick {} was answered", process,
                                         message.tick, tick->tick));
  }
  tick = message;
  ticked = true;
}

bool TickClient::Impl::AllHeld() const {
  for (const Requirement& requirement : requirements) {
    if (requirement.held_utime != tick->utime) return false;
  }
  return true;
}

void TickClient::Impl::ProcessIfComplete() {
  if (!tick || !AllHeld()) return;
  const tick_t current = *tick;
  for (Requirement& requirement : requirements) {
    requirement.deliver();
    requirement.held_utime.reset();
  }
  tick.reset();
  last_utime = current.utime;
  if (on_tick) on_tick(current);
  SayDone(current);
  // What is done only once (shaders, caches) is done in the rehearsal and would spoil the means.
  if (current.phase == tick_t::PHASE_REHEARSAL) timer = StageTimer();
}

void TickClient::Impl::SayHello() {
  hello_t hello{};
  hello.run_id = run_id;
  hello.process = process;
  hello.version = WINDHOVER_VERSION;
  hello.types = AllFingerprints();
  hello.n_types = static_cast<std::int32_t>(hello.types.size());
  hello.subscriptions = bus.Subscriptions();
  hello.n_subscriptions = static_cast<std::int32_t>(hello.subscriptions.size());
  bus.Publish(channel::kHello, hello);
}

void TickClient::Impl::SayDone(const tick_t& done) {
  answer.utime = done.utime;
  answer.run_id = done.run_id;
  answer.tick = done.tick;
  answer.process = process;
  answer.channels.resize(n_sent.size());
  std::size_t n_channels = 0;
  for (auto& [name, count] : n_sent) {
    if (count == 0) continue;
    answer.channels[n_channels].channel = name;
    answer.channels[n_channels++].n_sent = std::exchange(count, 0);
  }
  answer.channels.resize(n_channels);
  answer.n_channels = static_cast<std::int32_t>(n_channels);
  bus.Publish(channel::kTickDone, answer);
}

void TickClient::Impl::SayStatus() {
  status_t status = StatusOf(process, timer);
  status.n_ignored = n_ignored;
  status.n_dropped = bus.DroppedByKernel();
  status.peak_rss_mib = PeakMemory_mib();
  bus.Publish(channel::Status(process), status);
}

TickClient::TickClient(Bus& bus, std::string process, std::int64_t run_id)
    : impl_(std::make_unique<Impl>(bus, std::move(process), run_id)) {
  bus.Subscribe<tick_t>(channel::kTick, [this](const tick_t& message) {
    impl_->OnTickMessage(message);
    impl_->ProcessIfComplete();
  });
}

TickClient::~TickClient() = default;

void TickClient::RequireBytes(const std::string& channel,
                              std::function<void(std::size_t requirement, MessageBytes)> hold,
                              std::function<void()> deliver) {
  const std::size_t index = impl_->requirements.size();
  impl_->requirements.push_back({channel, std::nullopt, std::move(deliver)});
  impl_->bus.SubscribeBytes(
      channel, [this, index, hold = std::move(hold)](const std::string&, MessageBytes bytes) {
        hold(index, bytes);
        impl_->ProcessIfComplete();
      });
}

bool TickClient::Accept(std::size_t requirement, std::int64_t utime) {
  std::optional<std::int64_t>& held = impl_->requirements[requirement].held_utime;
  if (utime <= impl_->last_utime || (held && utime <= *held)) {
    ++impl_->n_ignored;
    return false;
  }
  held = utime;
  return true;
}

Bus& TickClient::MyBus() { return impl_->bus; }

void TickClient::CountSent(const std::string& channel) { ++impl_->n_sent[channel]; }

void TickClient::OnTick(std::function<void(const tick_t&)> process) {
  impl_->on_tick = std::move(process);
}

void TickClient::Announce() {
  const auto now = std::chrono::steady_clock::now();
  if (impl_->ticked || (impl_->last_hello && now - *impl_->last_hello < kHelloPeriod)) return;
  impl_->last_hello = now;
  impl_->SayHello();
}

StageTimer& TickClient::Timer() { return impl_->timer; }

bool TickClient::Ended() const { return impl_->ended; }

}  // namespace windhover
