#pragma once

#include <cstdint>
#include <string>

namespace windhover {

/// Who holds the other end of a local TCP connection, for people to read: "lcm-logger (pid 4711,
/// port 40222)", or "port 40222" where /proc does not tell.
std::string PeerName(std::uint16_t peer_port, std::uint16_t own_port);

}  // namespace windhover
