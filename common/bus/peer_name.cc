#include "common/bus/peer_name.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

namespace windhover {
namespace {

namespace fs = std::filesystem;

// Inode of the socket that is bound to `local_port` and connected to `remote_port`; empty if
// there is none. Columns of /proc/net/tcp: sl local remote st queues timer retransmits uid
// timeout inode.
std::string SocketInode(std::uint16_t local_port, std::uint16_t remote_port) {
  std::ifstream table("/proc/net/tcp");
  const std::string local = fmt::format(":{:04X}", local_port);
  const std::string remote = fmt::format(":{:04X}", remote_port);
  for (std::string line; std::getline(table, line);) {
    std::istringstream columns(line);
    std::string slot, from, to, skip, inode;
    columns >> slot >> from >> to >> skip >> skip >> skip >> skip >> skip >> skip >> inode;
    if (from.ends_with(local) && to.ends_with(remote)) return inode;
  }
  return "";
}

bool HoldsSocket(const fs::path& process, const std::string& target) {
  std::error_code error;
  for (fs::directory_iterator it(process / "fd", error), end; !error && it != end;
       it.increment(error)) {
    std::error_code unreadable;
    if (fs::read_symlink(it->path(), unreadable) == target) return true;
  }
  return false;
}

bool IsProcess(const fs::path& entry) {
  const std::string name = entry.filename().string();
  return std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

}  // namespace

std::string PeerName(std::uint16_t peer_port, std::uint16_t own_port) {
  const std::string inode = SocketInode(peer_port, own_port);
  const std::string target = fmt::format("socket:[{}]", inode);
  std::error_code error;
  for (fs::directory_iterator it("/proc", error), end; !inode.empty() && !error && it != end;
       it.increment(error)) {
    if (!IsProcess(it->path()) || !HoldsSocket(it->path(), target)) continue;
    std::string name;
    std::ifstream command(it->path() / "comm");
    std::getline(command, name);
    return fmt::format("{} (pid {}, port {})", name, it->path().filename().string(), peer_port);
  }
  return fmt::format("port {}", peer_port);
}

}  // namespace windhover
