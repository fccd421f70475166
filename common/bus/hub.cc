#include "common/bus/hub.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/epoll.h>
#include <sys/socket.h>

#include "common/bus/peer_name.h"

namespace windhover {
namespace {

constexpr int kStopPeriod_ms = 100;
constexpr std::chrono::seconds kDrainTime{2};
constexpr std::chrono::seconds kNamePeriod{1};
constexpr std::size_t kMaxCountedChannels = 10000;

[[noreturn]] void Fail(const std::string& what) {
  throw std::runtime_error(fmt::format("hub: {}: {}", what, std::strerror(errno)));
}

}  // namespace

Hub::Hub(const HubOptions& options)
    : options_(options),
      listener_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)) {
  const int on = 1;
  setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(options.port);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  if (bind(listener_.get(), any, size) != 0 || listen(listener_.get(), SOMAXCONN) != 0 ||
      getsockname(listener_.get(), any, &size) != 0) {
    Fail(fmt::format("cannot listen on 127.0.0.1:{}", options.port));
  }
  port_ = ntohs(address.sin_port);
  Listen(true);
}

Hub::~Hub() = default;

void Hub::Listen(bool on) {
  if (on == listening_) return;
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.fd = listener_.get();
  if (epoll_ctl(epoll_.get(), on ? EPOLL_CTL_ADD : EPOLL_CTL_DEL, listener_.get(), &event) != 0) {
    Fail("epoll_ctl");
  }
  listening_ = on;
}

void Hub::Run(const std::function<bool()>& stop) {
  while (!stop()) Step(kStopPeriod_ms);
  Listen(false);
  const auto deadline = HubClient::Clock::now() + kDrainTime;
  const auto has_queue = [](const auto& entry) { return entry.second->queued_bytes() > 0; };
  while (std::any_of(clients_.begin(), clients_.end(), has_queue) &&
         HubClient::Clock::now() < deadline) {
    Step(kStopPeriod_ms);
  }
  clients_.clear();  // They wait for our end of their connections.
}

void Hub::Step(int timeout_ms) {
  std::array<epoll_event, 64> events;
  const int n = epoll_wait(epoll_.get(), events.data(), events.size(), timeout_ms);
  if (n < 0 && errno != EINTR) Fail("epoll_wait");
  for (int i = 0; i < n; ++i) {
    const int socket = events[static_cast<std::size_t>(i)].data.fd;
    if (socket == listener_.get()) {
      Accept();
    } else {
      Serve(socket, events[static_cast<std::size_t>(i)].events);
    }
  }
  FlushAll();
  DropFullOnes();
  ResumePaused();
}

void Hub::Accept() {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  FileDescriptor socket(accept4(listener_.get(), reinterpret_cast<sockaddr*>(&address), &size,
                                SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (socket.get() < 0) {
    // Out of descriptors: the caller waits in the backlog until another client goes.
    if (errno == EMFILE || errno == ENFILE) Listen(false);
    return;
  }
  const int key = socket.get();
  auto client = std::make_unique<HubClient>(std::move(socket), ntohs(address.sin_port));
  epoll_event event{};
  event.events = client->watched = EPOLLIN;
  event.data.fd = key;
  if (epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, key, &event) != 0) return;
  clients_[key] = std::move(client);
  ++n_clients_;
}

void Hub::Serve(int socket, std::uint32_t events) {
  const auto found = clients_.find(socket);
  if (found == clients_.end()) return;
  HubClient& client = *found->second;
  if (client.paused && (events & (EPOLLERR | EPOLLHUP)) != 0) {
    Close(socket, "");
    return;
  }
  if (client.paused || (events & ~static_cast<std::uint32_t>(EPOLLOUT)) == 0) return;
  const std::string error = client.Read(
      [&](const std::shared_ptr<const HubMessage>& message) { Route(client, message); });
  if (!error.empty() || client.Closed()) Close(socket, error);
}

void Hub::Route(HubClient& from, const std::shared_ptr<const HubMessage>& message) {
  const bool known = counts_.contains(message->channel) || counts_.size() < kMaxCountedChannels;
  Count& count = counts_[known ? message->channel : "(others)"];
  ++count.in;
  for (auto& [socket, client] : clients_) {
    if (!client->Wants(message->channel)) continue;
    client->Queue(message);
    ++count.out;
    if (IsFull(*client) && !client->Flush()) continue;  // FlushAll() closes it.
    if (IsFull(*client)) from.paused = true;
  }
}

bool Hub::IsFull(const HubClient& client) const {
  return client.queued_bytes() >= options_.queue_bytes;
}

void Hub::FlushAll() {
  std::vector<int> broken;
  for (auto& [socket, client] : clients_) {
    if (!client->Flush()) {
      broken.push_back(socket);
      continue;
    }
    UpdateFull(*client);
  }
  for (const int socket : broken) Close(socket, "");
}

void Hub::UpdateFull(HubClient& client) {
  if (!IsFull(client)) {
    client.full_since = {};
  } else if (client.full_since == HubClient::Clock::time_point{}) {
    client.full_since = HubClient::Clock::now();
  }
}

void Hub::DropFullOnes() {
  const auto now = HubClient::Clock::now();
  std::vector<int> late;
  for (const auto& [socket, client] : clients_) {
    if (IsFull(*client) && !client->TakesPart() && now - client->full_since >= options_.patience) {
      late.push_back(socket);
    }
  }
  for (const int socket : late) {
    dropped_.push_back(NameOf(clients_.at(socket)->port()));
    Close(socket, fmt::format("has not kept up for {} ms", options_.patience.count()));
  }
}

void Hub::ResumePaused() {
  const bool any_full = std::any_of(clients_.begin(), clients_.end(),
                                    [&](const auto& entry) { return IsFull(*entry.second); });
  for (auto& [socket, client] : clients_) {
    if (!any_full) client->paused = false;
    Watch(*client);
  }
}

void Hub::Watch(HubClient& client) {
  std::uint32_t events = 0;
  if (!client.paused) events |= EPOLLIN;
  if (client.queued_bytes() > 0) events |= EPOLLOUT;
  if (events == client.watched) return;
  client.watched = events;
  epoll_event event{};
  event.events = events;
  event.data.fd = client.socket();
  if (epoll_ctl(epoll_.get(), EPOLL_CTL_MOD, client.socket(), &event) != 0) Fail("epoll_ctl");
}

void Hub::Close(int socket, const std::string& why) {
  const auto found = clients_.find(socket);
  if (found == clients_.end()) return;
  if (!why.empty()) {
    fmt::print(stderr, "windhover-hub: warning: {} {}: disconnected\n",
               NameOf(found->second->port()), why);
  }
  clients_.erase(found);
  Listen(true);
}

// Finding a process takes milliseconds: a crowd of bad clients must not stop the bus.
std::string Hub::NameOf(std::uint16_t port) {
  const auto now = HubClient::Clock::now();
  if (now - last_named_ < kNamePeriod && port != last_named_port_)
    return fmt::format("port {}", port);
  last_named_ = now;
  last_named_port_ = port;
  return PeerName(port, port_);
}

std::string Hub::CountsJson() const {
  nlohmann::json channels = nlohmann::json::object();
  const auto replace = nlohmann::json::error_handler_t::replace;
  for (const auto& [name, count] : counts_) {
    channels[name] = {{"in", count.in}, {"out", count.out}};
  }
  const nlohmann::json all = {
      {"channels", channels}, {"n_clients", n_clients_}, {"dropped", dropped_}};
  return all.dump(-1, ' ', true, replace);
}

}  // namespace windhover
