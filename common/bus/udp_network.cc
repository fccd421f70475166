#include "common/bus/udp_network.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include "common/bus/file_descriptor.h"

namespace windhover {
namespace {

constexpr const char* kScheme = "udpm://";

struct UdpmUrl {
  std::string group = "239.255.76.67";
  std::uint16_t port = 7667;
  std::string options;
};

UdpmUrl ParseUdpmUrl(const std::string& url) {
  UdpmUrl result;
  std::string rest = url.substr(std::string(kScheme).size());
  const std::size_t question = rest.find('?');
  if (question != std::string::npos) result.options = rest.substr(question + 1);
  rest.resize(std::min(rest.size(), question));
  const std::size_t colon = rest.find(':');
  if (colon != 0 && !rest.empty()) result.group = rest.substr(0, colon);
  if (colon == std::string::npos) return result;
  const char* end = rest.data() + rest.size();
  const auto read = std::from_chars(rest.data() + colon + 1, end, result.port);
  if (read.ec == std::errc() && read.ptr == end && result.port > 0 && result.port < 65535) {
    return result;
  }
  throw std::runtime_error(fmt::format("bus: '{}' has no port from 1 to 65534", url));
}

std::string Text(const UdpmUrl& url) {
  return fmt::format("{}{}:{}?{}", kScheme, url.group, url.port, url.options);
}

std::set<std::string> OwnSockets() {
  std::set<std::string> inodes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const std::string target = std::filesystem::read_symlink(entry.path(), error).string();
    if (target.starts_with("socket:[")) inodes.insert(target.substr(8, target.size() - 9));
  }
  return inodes;
}

}  // namespace

std::string CompleteUdpmUrl(const std::string& url) {
  UdpmUrl parsed = ParseUdpmUrl(url);
  for (const std::string option : {"ttl=0", "recv_buf_size=4194304"}) {
    if (parsed.options.find(option.substr(0, option.find('=') + 1)) != std::string::npos) continue;
    parsed.options += (parsed.options.empty() ? "" : "&") + option;
  }
  return Text(parsed);
}

std::string UdpmUrlOfNextPort(const std::string& url) {
  UdpmUrl parsed = ParseUdpmUrl(url);
  ++parsed.port;
  return Text(parsed);
}

std::string TileChannel(const std::string& channel) { return "TILE_" + channel; }

void RequireMulticastRoute(const std::string& url) {
  const UdpmUrl parsed = ParseUdpmUrl(url);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(parsed.port);
  if (inet_pton(AF_INET, parsed.group.c_str(), &address.sin_addr) != 1 ||
      !IN_MULTICAST(ntohl(address.sin_addr.s_addr))) {
    throw std::runtime_error(fmt::format("bus: '{}' is not a multicast address", parsed.group));
  }
  const FileDescriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return;
  throw std::runtime_error(
      fmt::format("bus: packets to {} have no route on this machine. Either, as root:\n"
                  "    ip link set lo up; ip route add 224.0.0.0/4 dev lo\n"
                  "or use the hub, which needs no multicast: --bus tcpq",
                  parsed.group));
}

std::int64_t UdpDropsOfThisProcess(const std::string& url) {
  const std::set<std::string> own = OwnSockets();
  const std::string port = fmt::format(":{:04X}", ParseUdpmUrl(url).port);
  std::ifstream table("/proc/net/udp");
  std::int64_t drops = 0;
  std::string line;
  std::getline(table, line);  // Names of the columns.
  while (std::getline(table, line)) {
    std::istringstream columns(line);
    std::string slot, local, skip, inode;
    columns >> slot >> local >> skip >> skip >> skip >> skip >> skip >> skip >> skip >> inode;
    std::string last;
    while (columns >> skip) last = skip;
    std::int64_t count = 0;
    std::from_chars(last.data(), last.data() + last.size(), count);
    if (local.ends_with(port) && own.contains(inode)) drops += count;
  }
  return drops;
}

}  // namespace windhover
