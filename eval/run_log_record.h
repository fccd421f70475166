#pragma once

#include <filesystem>

#include "eval/run_record.h"

namespace windhover {

/// Reads a flight from its log. A log that is damaged, cut short, or lacks frames that its
/// RUN_END speaks of gives an invalid record with the reason, and all that could be read.
/// @throws std::runtime_error if the file cannot be read, has no RUN_HEADER, or holds a
/// malformed message; ConfigError if the scenario in its header cannot be read.
RunRecord ReadRunRecord(const std::filesystem::path& log);

}  // namespace windhover
