#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "scenarios/scenario.h"

namespace windhover {

/// What a replay is to do.
struct ReplayOptions {
  std::filesystem::path log;      ///< The recorded flight.
  std::filesystem::path out;      ///< Folder for the run.lcm of the replay.
  std::string estimator_command;  ///< A program to ask instead of our estimator; may be empty.
  int threads = 1;
};

/// How the replay compares with the recording.
struct ReplayResult {
  int n_ticks = 0;
  std::int64_t n_events = 0;  ///< Compared.
  std::int64_t n_different = 0;
  std::string first_difference;  ///< "RANGE_0 at 1.2 s"; empty where there is none.
};

/// Feeds the truth, navigation and commands of a log to render and estimator again, tick by tick,
/// and writes a log of what they say: byte by byte the recorded one if they are the same.
/// @throws std::runtime_error if the log cannot be read, RunInvalid if a process fails.
ReplayResult ReplayLog(const Scenario& scenario, const ReplayOptions& options);

/// The scenario in the header of a log.
Scenario ScenarioOfLog(const std::filesystem::path& log);

}  // namespace windhover
