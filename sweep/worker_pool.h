#pragma once

#include <functional>
#include <vector>

#include "sweep/journal.h"
#include "sweep/sweep_plan.h"

namespace windhover {

/// Where a worker's run is to work: not removed, and its content not looked at, by the pool.
struct RunPlace {
  int worker = 0;
  int attempt = 0;  ///< 0 at first; more after an invalid run.
};

/// One run. Its row may lack point and seed; an exception makes it invalid.
using RunFunction =
    std::function<RunRow(const Scenario& drawn, std::size_t point, const RunPlace& place)>;

struct PoolOptions {
  std::filesystem::path journal;
  int jobs = 1;
  std::vector<int> points;                         ///< To be done, in this order.
  std::function<void(int done)> on_progress = {};  ///< Runs that have ended, in all.
  std::function<bool()> stop_requested = {};       ///< May be empty.
};

/// Runs what the journal does not have yet, in `jobs` processes, each of which takes the next point
/// when it has done one, and all runs of it until the stop rule holds: rows do not depend on how
/// many there are. An invalid run is tried again as often as the plan says; one that kills its
/// process is invalid, and another process goes on.
/// @return false if a stop was requested before all was done.
/// @throws std::runtime_error if a worker fails for another reason than a run.
bool RunPool(const SweepPlan& plan, const RunFunction& run, const PoolOptions& options);

}  // namespace windhover
