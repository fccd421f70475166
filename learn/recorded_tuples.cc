#include "learn/recorded_tuples.h"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "eval/run_log_record.h"
#include "eval/samples.h"

namespace windhover {
namespace {

namespace fs = std::filesystem;

constexpr Utime kBetweenSplits_us = 1'000'000;

/// By observer, in order of time.
using Flights = std::map<int, std::vector<StereoTuple>>;

Flights FlightsOf(const RunRecord& run) {
  Flights flights;
  for (const TargetFrame& frame : CollectTargetFrames(run).frames) {
    if (!frame.box) continue;
    flights[frame.observer_id].push_back({.box = *frame.box,
                                          .range_m = frame.reference_m,
                                          .range_true_m = frame.truth.range_m,
                                          .utime = frame.utime});
  }
  return flights;
}

void AddFlight(std::vector<StereoTuple> flight, std::vector<StereoTuple>* split) {
  const int number = split->empty() ? 0 : split->back().flight + 1;
  for (StereoTuple& tuple : flight) tuple.flight = number;
  split->insert(split->end(), flight.begin(), flight.end());
}

void AddByTime(const std::vector<StereoTuple>& flight, TupleSplits* splits) {
  const TupleSplits parts = SplitAsThePaper(flight);
  const auto later = [](const std::vector<StereoTuple>& before, std::vector<StereoTuple> part) {
    if (before.empty()) return part;
    std::erase_if(part, [&](const StereoTuple& tuple) {
      return tuple.utime - before.back().utime < kBetweenSplits_us;
    });
    return part;
  };
  AddFlight(parts.train, &splits->train);
  AddFlight(later(parts.train, parts.val), &splits->val);
  AddFlight(later(parts.val, parts.test), &splits->test);
}

/// The split of run number `run` of `n`, at least one a split.
std::vector<StereoTuple>* SplitOfRun(std::size_t run, std::size_t n, TupleSplits* splits) {
  const std::size_t fewer = std::max<std::size_t>(1, n * 540 / 3895);  // 541 and 539 in the paper.
  if (run + fewer >= n) return &splits->test;
  return run + 2 * fewer >= n ? &splits->val : &splits->train;
}

bool AreSame(const StereoRig& a, const StereoRig& b) {
  const auto corner = [](const StereoRig& rig) { return rig.left.Unproject({0, 0}); };
  return a.baseline_m == b.baseline_m && a.width_px == b.width_px && a.height_px == b.height_px &&
         a.left.fx_px() == b.left.fx_px() && corner(a) == corner(b);
}

void CheckRun(const RunRecord& run, const StereoRig& first, const std::string& name) {
  if (!run.valid) {
    throw ConfigError(fmt::format("{}: must be a valid run (found: {})", name, run.invalid_reason));
  }
  if (!AreSame(run.scenario.rig.calibrated.ToStereoRig(), first)) {
    throw ConfigError(
        fmt::format("{}: must have flown the same calibrated rig as the first run", name));
  }
}

}  // namespace

RecordedTuples TuplesOfRuns(const std::vector<RunRecord>& runs,
                            const std::vector<std::string>& names) {
  RecordedTuples recorded{.rig = runs.at(0).scenario.rig.calibrated.ToStereoRig(),
                          .tuples = {},
                          .split_by_run = runs.size() >= 3};
  TupleSplits& splits = recorded.tuples;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    CheckRun(runs[i], recorded.rig, names[i]);
    for (const auto& [observer, flight] : FlightsOf(runs[i])) {
      if (recorded.split_by_run) {
        AddFlight(flight, SplitOfRun(i, runs.size(), &splits));
      } else {
        AddByTime(flight, &splits);
      }
    }
  }
  if (splits.train.empty() || splits.val.empty() || splits.test.empty()) {
    throw ConfigError(
        fmt::format("{}: must have detections with labels to learn from, to choose by and to "
                    "report (found {}, {} and {})",
                    names[0], splits.train.size(), splits.val.size(), splits.test.size()));
  }
  return recorded;
}

RecordedTuples ReadRecordedTuples(const fs::path& folder) {
  std::vector<fs::path> logs;
  if (fs::exists(folder / "run.lcm")) {
    logs = {folder / "run.lcm"};
  } else {
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (fs::exists(entry.path() / "run.lcm")) logs.push_back(entry.path() / "run.lcm");
    }
  }
  if (logs.empty()) {
    throw ConfigError(fmt::format(
        "{}: must be the folder of a run, or hold such (found no run.lcm)", folder.string()));
  }
  std::sort(logs.begin(), logs.end());
  std::vector<RunRecord> runs;
  std::vector<std::string> names;
  for (const fs::path& log : logs) {
    runs.push_back(ReadRunRecord(log));
    names.push_back(log.string());
  }
  return TuplesOfRuns(runs, names);
}

}  // namespace windhover
