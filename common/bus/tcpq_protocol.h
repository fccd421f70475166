#pragma once

#include <cstddef>
#include <cstdint>

// LCM's tcpq protocol, as its C client speaks it (lcm_tcpq.c of LCM 1.3.1). All integers are
// uint32, big-endian. Both sides begin with their magic and the version; then the client sends
//
//     PUBLISH      length, channel, length, data
//     SUBSCRIBE    length, pattern (a regular expression for whole names)
//     UNSUBSCRIBE  length, pattern
//
// and the server sends PUBLISH.
namespace windhover::tcpq {

inline constexpr std::uint32_t kServerMagic = 0x287617fa;
inline constexpr std::uint32_t kClientMagic = 0x287617fb;
inline constexpr std::uint32_t kVersion = 0x0100;
inline constexpr std::uint32_t kPublish = 1;
inline constexpr std::uint32_t kSubscribe = 2;
inline constexpr std::uint32_t kUnsubscribe = 3;

inline constexpr std::size_t kMaxChannelBytes = 63;
inline constexpr std::size_t kMaxPatternBytes = 4096;
inline constexpr std::size_t kMaxDataBytes = std::size_t{1} << 28;

}  // namespace windhover::tcpq
