#include "common/bus/bus.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <exception>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include <fmt/format.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "common/bus/tcpq_probe.h"
#include "common/bus/udp_network.h"
#include "common/bus/udp_tiles.h"

namespace windhover {
namespace {

constexpr int kTilePeriod_ms = 100;
constexpr std::size_t kSpareBytes = 1 << 16;  // Pixels are not kept.

// LCM takes a subscription as a regular expression, so a name may hold no character that means
// something there.
void RequirePlainName(const std::string& channel) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  if (!channel.empty() && channel.size() <= LCM_MAX_CHANNEL_NAME_LENGTH &&
      std::all_of(channel.begin(), channel.end(), is_plain)) {
    return;
  }
  throw std::runtime_error(fmt::format(
      "bus: '{}' is not a channel name (1 to 63 letters, digits, '_' or '-')", channel));
}

// Closing a socket that has unread bytes resets the connection, and what was sent last may be
// lost. So: say that nothing more comes, and read until the hub has closed its side.
void FinishSending(int socket) {
  if (socket < 0 || shutdown(socket, SHUT_WR) != 0) return;
  std::array<char, 65536> unread;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < deadline) {
    pollfd readable{.fd = socket, .events = POLLIN, .revents = 0};
    if (poll(&readable, 1, 100) > 0 && recv(socket, unread.data(), unread.size(), 0) <= 0) return;
  }
}

}  // namespace

struct Bus::Impl {
  // One LCM subscription per channel, so that a message counts once however many read it.
  struct Channel {
    Impl* bus;
    std::string name;
    std::vector<std::function<void(const std::string&, MessageBytes)>> handlers;
    ChannelCount count;
  };

  // Called by LCM. Nothing may be thrown through its C frames: an exception waits in `error`.
  static void OnMessage(const lcm_recv_buf_t* buffer, const char*, void* user) noexcept {
    auto* channel = static_cast<Channel*>(user);
    const auto* data = static_cast<const std::uint8_t*>(buffer->data);
    channel->bus->Dispatch(*channel, MessageBytes(data, buffer->data_size));
  }

  void Dispatch(Channel& channel, MessageBytes bytes) noexcept {
    ++channel.count.received;
    try {
      // liblcm passes on a huge size for a datagram that is only a header.
      if (bytes.size() > LCM_MAX_MESSAGE_SIZE) throw MalformedMessage("has an impossible size");
      for (std::size_t i = 0; i < channel.handlers.size(); ++i) {
        channel.handlers[i](channel.name, bytes);
      }
    } catch (const MalformedMessage& e) {
      ++channel.count.rejected;
      error = std::make_exception_ptr(
          std::runtime_error(fmt::format("bus: a message on {} is {}", channel.name, e.what())));
    } catch (...) {
      error = std::current_exception();
    }
  }

  Channel& ChannelNamed(const std::string& name);
  void PublishHere(Channel* channel, MessageBytes bytes);
  bool HandleHere();
  bool WaitForMessage(int timeout_ms);
  bool HandleTiles();
  void RethrowError();
  int Socket() const { return lcm_get_fileno(lcm.get()); }

  [[noreturn]] void HubIsGone() const {
    throw std::runtime_error(fmt::format("bus: the hub at {} is gone", url));
  }

  std::string url;
  bool is_tcpq = false, is_memq = false;
  std::unique_ptr<lcm_t, void (*)(lcm_t*)> lcm{nullptr, lcm_destroy};
  std::unordered_map<std::string, std::unique_ptr<Channel>> channels;  // Never iterated unsorted.
  std::unique_ptr<UdpTiles> tiles;                                     // On udpm only.
  std::vector<std::string> subscriptions;
  std::exception_ptr error;
  // On memq only, where LCM's own queue costs a write, a poll and a read a message.
  std::deque<std::pair<Channel*, std::vector<std::uint8_t>>> waiting;
  std::vector<std::vector<std::uint8_t>> spare;
};

Bus::Bus(const std::string& url) : impl_(std::make_unique<Impl>()) {
  const bool is_udpm = url.starts_with("udpm://");
  impl_->is_tcpq = url.starts_with("tcpq://");
  impl_->is_memq = url.starts_with("memq:");
  impl_->url = is_udpm ? CompleteUdpmUrl(url) : url;
  if (impl_->is_tcpq) RequireTcpqServer(url);
  if (is_udpm) RequireMulticastRoute(url);
  impl_->lcm.reset(lcm_create(impl_->url.c_str()));
  if (!impl_->lcm || lcm_get_fileno(impl_->lcm.get()) < 0) {
    throw std::runtime_error(fmt::format("bus: cannot open '{}'", url));
  }
  const int on = 1;
  if (impl_->is_tcpq) setsockopt(impl_->Socket(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (is_udpm) impl_->tiles = std::make_unique<UdpTiles>(impl_->url);
}

Bus::~Bus() {
  if (impl_->is_tcpq) FinishSending(impl_->Socket());
}

void Bus::PublishBytes(const std::string& channel, MessageBytes bytes) {
  Impl::Channel& entry = impl_->ChannelNamed(channel);
  if (impl_->is_tcpq && impl_->Socket() < 0) impl_->HubIsGone();  // liblcm would reconnect.
  const auto size = static_cast<unsigned int>(bytes.size());
  if (impl_->is_memq) {
    impl_->PublishHere(&entry, bytes);
  } else if (impl_->tiles && UdpTiles::NeedsTiles(size)) {
    impl_->tiles->Publish(channel, bytes);
  } else if (lcm_publish(impl_->lcm.get(), channel.c_str(), bytes.data(), size) != 0) {
    throw std::runtime_error(fmt::format("bus: cannot publish on {} ({})", channel, impl_->url));
  }
  ++entry.count.sent;
}

void Bus::SubscribeBytes(const std::string& channel,
                         std::function<void(const std::string& channel, MessageBytes)> handler) {
  Impl::Channel& entry = impl_->ChannelNamed(channel);
  if (entry.handlers.empty()) {
    lcm_subscription_t* subscription =
        lcm_subscribe(impl_->lcm.get(), channel.c_str(), &Impl::OnMessage, &entry);
    if (subscription == nullptr) {
      throw std::runtime_error(fmt::format("bus: cannot subscribe to {}", channel));
    }
    lcm_subscription_set_queue_capacity(subscription, 0);  // LCM drops beyond 30 by default.
    impl_->subscriptions.push_back(channel);
    if (impl_->tiles) impl_->tiles->Subscribe(channel);
  }
  entry.handlers.push_back(std::move(handler));
}

Bus::Impl::Channel& Bus::Impl::ChannelNamed(const std::string& name) {
  const auto found = channels.find(name);
  if (found != channels.end()) return *found->second;
  RequirePlainName(name);
  return *channels.emplace(name, std::make_unique<Channel>(Channel{this, name, {}, {}}))
              .first->second;
}

void Bus::Impl::PublishHere(Channel* channel, MessageBytes bytes) {
  if (channel->handlers.empty()) return;
  std::vector<std::uint8_t> copy;
  if (!spare.empty()) {
    copy = std::move(spare.back());
    spare.pop_back();
  }
  copy.assign(bytes.begin(), bytes.end());
  waiting.emplace_back(channel, std::move(copy));
}

bool Bus::Impl::HandleHere() {
  if (waiting.empty()) return false;
  auto [channel, bytes] = std::move(waiting.front());
  waiting.pop_front();
  Dispatch(*channel, bytes);
  if (bytes.size() < kSpareBytes) spare.push_back(std::move(bytes));
  return true;
}

// Not lcm_handle_timeout(): its select() aborts the process for a descriptor of -1 or >= 1024.
bool Bus::Impl::WaitForMessage(int timeout_ms) {
  if (Socket() < 0) HubIsGone();
  std::array<pollfd, 2> readable = {pollfd{.fd = Socket(), .events = POLLIN, .revents = 0},
                                    pollfd{.fd = -1, .events = POLLIN, .revents = 0}};
  if (tiles) {
    readable[1].fd = tiles->Socket();
    timeout_ms = std::min(timeout_ms, kTilePeriod_ms);
  }
  const int n_ready = poll(readable.data(), readable.size(), timeout_ms);
  if (n_ready < 0 && errno != EINTR) {
    throw std::runtime_error(fmt::format("bus: poll: {}", std::strerror(errno)));
  }
  return n_ready > 0 && readable[0].revents != 0;
}

// A whole message that came in tiles; they are acknowledged and announced here too.
bool Bus::Impl::HandleTiles() {
  tiles->Receive();
  const std::optional<UdpTiles::Message> message = tiles->Take();
  if (message) Dispatch(*channels.at(message->channel), message->bytes);
  return message.has_value();
}

void Bus::Impl::RethrowError() {
  if (error) std::rethrow_exception(std::exchange(error, nullptr));
}

bool Bus::Handle(int timeout_ms) {
  if (impl_->is_memq) {
    const bool came = impl_->HandleHere();
    impl_->RethrowError();
    return came;
  }
  const bool is_readable = impl_->WaitForMessage(timeout_ms);
  if (impl_->tiles && impl_->HandleTiles()) {
    impl_->RethrowError();
    return true;
  }
  if (!is_readable) return false;
  char first = 0;
  if (impl_->is_tcpq && recv(impl_->Socket(), &first, 1, MSG_PEEK) <= 0) impl_->HubIsGone();
  const int result = lcm_handle(impl_->lcm.get());
  impl_->RethrowError();
  if (result < 0 && impl_->is_tcpq) impl_->HubIsGone();
  if (result < 0) {
    throw std::runtime_error(fmt::format("bus: receiving from {} failed", impl_->url));
  }
  return true;
}

bool Bus::InProcess() const { return impl_->is_memq; }

std::int64_t Bus::DroppedByKernel() const {
  return impl_->tiles ? UdpDropsOfThisProcess(impl_->url) : 0;
}

const std::vector<std::string>& Bus::Subscriptions() const { return impl_->subscriptions; }

std::map<std::string, ChannelCount> Bus::Counts() const {
  std::map<std::string, ChannelCount> counts;
  for (const auto& [name, channel] : impl_->channels) {
    const ChannelCount& count = channel->count;
    if (count.sent + count.received > 0) counts[name] = count;
  }
  return counts;
}

const ChannelCount& Bus::CountOf(const std::string& channel) const {
  return impl_->ChannelNamed(channel).count;
}

}  // namespace windhover
