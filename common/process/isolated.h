#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace windhover {

/// Runs `work` in a child process, so that a library which crashes, never ends or eats memory over
/// a broken file takes nothing else down. The child may use 4 GiB and 5 s of CPU, and
/// a second more for each MiB of `input_bytes`; it sees this process as it is and leaves no trace
/// in it.
/// @return what `work` returns: any bytes.
/// @throws ConfigError with the text of any exception of `work`, or with "the reader crashed
/// (SIGSEGV)" and the like.
std::string RunIsolated(std::uintmax_t input_bytes, const std::function<std::string()>& work);

}  // namespace windhover
