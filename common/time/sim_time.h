#pragma once

#include <cmath>
#include <cstdint>

namespace windhover {

/// Simulated time in the messages: microseconds since the start of the run.
using Utime = std::int64_t;

inline double SecondsFromUtime(Utime utime) { return static_cast<double>(utime) * 1e-6; }
inline Utime UtimeFromSeconds(double t_s) { return std::llround(t_s * 1e6); }

/// Time of tick `k` at `rate_hz`: rounded from the exact product, so that errors do not add up.
inline Utime UtimeOfTick(int k, double rate_hz) { return UtimeFromSeconds(k / rate_hz); }

}  // namespace windhover
