#pragma once

#include <string>

#include <fmt/format.h>

// Channels that only a simulator has.
namespace windhover::channel {

inline const std::string kUavTruth = "UAV_TRUTH";
inline const std::string kRunHeader = "RUN_HEADER";
inline const std::string kRunEnd = "RUN_END";

inline std::string Annotation(int id) { return fmt::format("ANNOTATION_{}", id); }

}  // namespace windhover::channel
