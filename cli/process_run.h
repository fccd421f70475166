#pragma once

#include <filesystem>

#include "cli/run_options.h"
#include "cli/run_summary.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Runs `run_dir`/resolved.yaml with real processes: the hub, sim, and as many of render,
/// estimator and swarm as the scenario says. Ends within the scenario's deadline + 2 s of any
/// process dying or standing still, names it, and leaves no process behind.
/// @throws std::runtime_error if a program cannot be started.
RunSummary RunProcesses(const Scenario& scenario, const std::filesystem::path& run_dir,
                        const RunOptions& options);

/// The folder that this program and those it starts are in.
std::filesystem::path ProgramFolder();

}  // namespace windhover
