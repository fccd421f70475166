#pragma once

#include <string>

// Channels that only a simulator has.
namespace windhover::channel {

inline const std::string kUavTruth = "UAV_TRUTH";
inline const std::string kRunHeader = "RUN_HEADER";
inline const std::string kRunEnd = "RUN_END";

inline std::string Annotation(int id) { return "ANNOTATION_" + std::to_string(id); }

}  // namespace windhover::channel
