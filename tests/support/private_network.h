#pragma once

#include <cstdlib>

#include <sched.h>

namespace windhover {

/// Moves this process into a network of its own, with multicast over loopback if `with_route`.
/// False where that is not permitted.
inline bool EnterPrivateNetwork(bool with_route) {
  if (unshare(CLONE_NEWNET) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0) return false;
  // Fails harmlessly where a user of the new namespace may not; the route then fails too.
  const bool up = std::system("ip link set lo up") == 0;
  return up && (!with_route || std::system("ip route add 224.0.0.0/4 dev lo") == 0);
}

}  // namespace windhover
