#pragma once

#include <string>

namespace windhover {

/// Asks for LCM's tcpq greeting at `url` ("tcpq://127.0.0.1:7700"). liblcm 1.3.1 opens a bus
/// without a server all the same and aborts the process later.
/// @throws std::runtime_error saying what is there instead and how to start a hub.
void RequireTcpqServer(const std::string& url);

}  // namespace windhover
