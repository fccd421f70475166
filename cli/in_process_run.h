#pragma once

#include <filesystem>

#include "cli/run_options.h"
#include "cli/run_summary.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Runs all nodes on one memq bus in this process; the log is that of RunProcesses, byte by byte.
RunSummary RunInOneProcess(const Scenario& scenario, const std::filesystem::path& run_dir,
                           const RunOptions& options);

}  // namespace windhover
