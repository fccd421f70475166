#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/bus/codec.h"
#include "lcmtypes/type_fingerprint_t.hpp"

namespace windhover {

/// The fingerprint of every message type of this build, sorted by name.
std::vector<type_fingerprint_t> AllFingerprints();

/// Name of the message type that belongs on `channel` ("NAV_STATE_3" -> "nav_state_t"), by the
/// table of lcmtypes/README.md; empty for a channel that is not in it.
std::string TypeOnChannel(const std::string& channel);

/// Throws MalformedMessage unless the bytes are a well-formed message.
using LayoutCheck = void (*)(MessageBytes);

/// The check of what belongs on `channel`, for who has many messages of it; null for a channel that
/// is not in the table.
LayoutCheck LayoutCheckOf(const std::string& channel);

/// @throws MalformedMessage unless `bytes` are a well-formed message of the type that belongs on
/// `channel`. Channels that are not in the table pass.
void CheckChannelLayout(const std::string& channel, MessageBytes bytes);

}  // namespace windhover
