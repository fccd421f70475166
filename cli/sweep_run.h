#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sweep/worker_pool.h"

namespace windhover {

/// How the runs of a sweep are done and where what they leave goes.
struct SweepRunOptions {
  std::filesystem::path out;         ///< Works in work/, keeps in failed/.
  std::vector<std::string> metrics;  ///< Paths in score.json.
  int keep = 20;                     ///< Folders in failed/, at most.
};

/// One run of a sweep and its score, for a worker of RunPool: in this process if there are no
/// images, else with processes of its own. Of runs that do not pass the folder is kept.
RunRow RunAndScore(const Scenario& drawn, std::size_t point, const RunPlace& place,
                   const SweepRunOptions& options);

/// How many such runs fit on this machine side by side: one a core, less if memory is short.
int JobsThatFit(const Scenario& scenario);

}  // namespace windhover
