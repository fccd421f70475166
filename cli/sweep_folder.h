#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/process/process.h"
#include "sweep/journal.h"
#include "sweep/sweep_plan.h"

namespace windhover {

/// The folder that one sweep, or one shard of it, writes: plan.json, shard.json, runs.jsonl,
/// table.csv, points.csv, junit.xml, report.html, figures/, failed/. While this lives no other
/// process uses it.
class SweepFolder {
 public:
  /// Makes the folder, or with `resume` goes on in one that has the same plan and share.
  /// @throws ConfigError if it is another sweep's, or has other files, or is in use.
  SweepFolder(std::filesystem::path path, const nlohmann::ordered_json& plan,
              const ProcessShare& share, bool resume);
  ~SweepFolder();
  SweepFolder(const SweepFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path journal() const { return path_ / "runs.jsonl"; }

 private:
  void Lock();
  void CheckContent(const nlohmann::ordered_json& plan, const nlohmann::ordered_json& shard,
                    bool resume) const;

  std::filesystem::path path_;
  int lock_ = -1;
};

/// The runs of several shards of one sweep together.
struct MergedSweep {
  StoredPlan stored;
  RunRows rows;
};

/// @throws ConfigError if they are not shards of one sweep, or not all of them.
MergedSweep MergeShards(const std::vector<std::string>& folders);

/// Writes the tables and what follows from them into `folder`, prints a summary. All of a sweep's
/// runs must be there.
/// @return exit code: 0, 1 if a gate fails, 3 if a run is invalid.
int FinishSweep(const SweepPlan& plan, const RunRows& rows, const std::filesystem::path& folder);

}  // namespace windhover
