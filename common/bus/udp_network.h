#pragma once

#include <cstdint>
#include <string>

namespace windhover {

/// `url` ("udpm://GROUP:PORT?…") with what LCM's defaults lack: ttl=0 and a receive buffer of
/// 4 MiB, unless they are given.
std::string CompleteUdpmUrl(const std::string& url);

/// The same with the port above; large messages go there.
std::string UdpmUrlOfNextPort(const std::string& url);

/// Channel of the tiles of `channel`.
std::string TileChannel(const std::string& channel);

/// @throws std::runtime_error with the command that mends it if packets to the group have no
/// route. liblcm waits 10 s and then says less.
void RequireMulticastRoute(const std::string& url);

/// Datagrams that the kernel has dropped at this process's sockets on the port of `url`.
std::int64_t UdpDropsOfThisProcess(const std::string& url);

}  // namespace windhover
