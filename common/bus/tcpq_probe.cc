#include "common/bus/tcpq_probe.h"

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <stdexcept>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "common/bus/file_descriptor.h"
#include "common/bus/tcpq_protocol.h"

namespace windhover {
namespace {

constexpr timeval kTimeout{.tv_sec = 2, .tv_usec = 0};

struct Address {
  std::string host = "127.0.0.1";
  std::string port = "7700";
};

Address AddressOf(const std::string& url) {
  Address address;
  std::string rest = url.substr(std::strlen("tcpq://"));
  rest.resize(std::min(rest.size(), rest.find('?')));
  const std::size_t colon = rest.find(':');
  if (!rest.substr(0, colon).empty()) address.host = rest.substr(0, colon);
  if (colon != std::string::npos) address.port = rest.substr(colon + 1);
  return address;
}

[[noreturn]] void Fail(const std::string& url, const std::string& what) {
  throw std::runtime_error(fmt::format(
      "bus: {} at {}; start `windhover-hub --port PORT` and give its URL as --lcm-url", what, url));
}

FileDescriptor Connect(const std::string& url) {
  const Address address = AddressOf(url);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list) != 0) {
    Fail(url, "there is no such host or port");
  }
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(list, freeaddrinfo);
  FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &kTimeout, sizeof kTimeout);
  setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &kTimeout, sizeof kTimeout);
  if (connect(socket.get(), list->ai_addr, list->ai_addrlen) != 0) {
    Fail(url, fmt::format("no hub answers ({})", std::strerror(errno)));
  }
  return socket;
}

}  // namespace

void RequireTcpqServer(const std::string& url) {
  const FileDescriptor socket = Connect(url);
  const std::array<std::uint32_t, 2> question = {htonl(tcpq::kClientMagic), htonl(tcpq::kVersion)};
  std::array<std::uint32_t, 2> answer = {};
  if (send(socket.get(), question.data(), sizeof question, MSG_NOSIGNAL) != sizeof question ||
      recv(socket.get(), answer.data(), sizeof answer, MSG_WAITALL) != sizeof answer ||
      ntohl(answer[0]) != tcpq::kServerMagic) {
    Fail(url, "something that is no LCM hub answers");
  }
}

}  // namespace windhover
