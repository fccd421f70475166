#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "cli/run_options.h"
#include "cli/run_summary.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Version and commit of this program.
std::string BuildName();

/// The content of manifest.json: what ran, where, on which inputs, with which result. sha256 of
/// run.lcm is that of the file now in `run_dir`.
nlohmann::ordered_json Manifest(const Scenario& scenario, const RunOptions& options,
                                const RunSummary& summary, const std::filesystem::path& run_dir);

/// The content of timing.json, all measured by wall clock:
/// {"wall_s", "simulated_s", "real_time_factor", "stereo_pairs_per_s",
///  "ms": {"render", "transport", "detect", "estimate", "control"}, "stages", "peak_rss_mib"};
/// `ms` is the mean time of a tick; transport is what the stages leave of sim's wait for them.
nlohmann::ordered_json Timing(const Scenario& scenario, const RunSummary& summary);

}  // namespace windhover
