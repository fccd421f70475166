#pragma once

#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/stereo_box_t.hpp"

namespace windhover {

/// A stereo detection with its label: what corrections are trained on.
struct StereoTuple {
  stereo_box_t box{};
  double range_m = 0;       ///< The label: score.reference of the scenario.
  double range_true_m = 0;  ///< From the middle of the baseline.
  int flight = 0;           ///< Within its split.
  Utime utime = 0;
};

/// Tuples in order of flight, then of time; no flight is in two splits.
struct TupleSplits {
  std::vector<StereoTuple> train, val, test;
};

}  // namespace windhover
