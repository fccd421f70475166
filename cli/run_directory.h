#pragma once

#include <filesystem>
#include <string>

#include "cli/run_options.h"

namespace windhover {

/// Writes `text` beside `file`, then puts it in its place, so that a reader never sees half.
/// @throws std::runtime_error naming the file if it cannot be written.
void ReplaceFile(const std::filesystem::path& file, const std::string& text);

/// Makes the folder of a run: `out`, or runs/<name>-<n> with the first n that is free, where
/// `name` is that of the scenario file. An earlier run in `out` is removed.
/// @throws ConfigError if `out` has something in it that is not a run.
std::filesystem::path MakeRunDirectory(const std::string& scenario_file, const std::string& out);

}  // namespace windhover
