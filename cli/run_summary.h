#pragma once

#include <map>
#include <string>

#include <nlohmann/json.hpp>

namespace windhover {

/// How a run went, seen from outside: what its log cannot say.
struct RunSummary {
  bool valid = false;
  bool interrupted = false;
  std::string culprit;  ///< The process at fault, "render-0"; empty when valid.
  std::string reason;   ///< What it did; empty when valid.
  int n_ticks = 0;      ///< Ticks finished.
  double wall_s = 0;    ///< From the first tick to the end.
  /// Per process, a list of {"stage", "n", "wall_ms", "cpu_ms"}.
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  /// Messages per channel, {"sent", "received", …}.
  nlohmann::ordered_json counters = nlohmann::ordered_json::object();
  std::map<std::string, double> peak_rss_mib;
};

}  // namespace windhover
