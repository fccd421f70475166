#pragma once

#include <filesystem>
#include <string>

#include "cli/run_options.h"

namespace windhover {

/// Makes the folder of a run: `out`, or runs/<name>-<n> with the first n that is free, where
/// `name` is that of the scenario file. An earlier run in `out` is removed.
/// @throws ConfigError if `out` has something in it that is not a run.
std::filesystem::path MakeRunDirectory(const std::string& scenario_file, const std::string& out);

}  // namespace windhover
