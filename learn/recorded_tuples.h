#pragma once

#include <filesystem>
#include <vector>

#include "camera/stereo_rig.h"
#include "eval/run_record.h"
#include "learn/stereo_tuple.h"

namespace windhover {

struct RecordedTuples {
  StereoRig rig;  ///< The calibrated one that the runs flew.
  TupleSplits tuples;
  bool split_by_run = false;  ///< Else by time.
};

/// Every detection of a target that a run would score, with score.reference as label, as
/// DrawTuples() (learn/tuple_source.h) has them.
///
/// From three runs on, no run is in two splits: they follow each other in the shares of
/// SplitAsThePaper(), at least one a split. Fewer are split by time in the same shares, 1 s left
/// out between two splits, since neighbouring frames err alike; their rig is the same in all
/// three, so that the test split says nothing about another flight's.
/// Each observer of each run is a flight of its split.
/// @throws ConfigError for an invalid run, another rig than the first run's, and a split without
/// tuples; `names` are those of the runs in messages.
RecordedTuples TuplesOfRuns(const std::vector<RunRecord>& runs,
                            const std::vector<std::string>& names);

/// Reads `folder`/run.lcm, or `folder`/*/run.lcm in order of their names.
/// @throws as TuplesOfRuns(), and ConfigError if there is none.
RecordedTuples ReadRecordedTuples(const std::filesystem::path& folder);

}  // namespace windhover
