#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace windhover {

/// What `windhover run` was asked for.
struct RunOptions {
  std::string scenario_file;
  std::string out;  ///< Empty: runs/<name>-<n>.
  std::optional<std::uint64_t> seed;
  std::vector<std::string> overrides;  ///< "a.b.c=value"
  std::string bus;                     ///< tcpq | udpm | URL; empty: chosen by `observe`.
  std::string observe;                 ///< Empty: as the scenario says.
  std::string record = "none";
  bool in_process = false;
  int threads = 1;
  std::string isa;
  std::string frames = "lcm";
  bool preview = false;
  bool realtime = false;
  bool no_report = false;
  bool as_json = false;
  bool quiet = false;     ///< Nothing but errors on stderr.
  std::string estimator;  ///< Command of a program to ask instead of ours; or empty.
};

}  // namespace windhover
