#pragma once

#include <optional>
#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/stereo_box_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// The target in one frame, as the score of a run counts it (eval/samples.h).
struct FlownFrame {
  int tick = 0;
  Utime utime = 0;
  std::optional<stereo_box_t> box;  ///< Nothing: not detected.
  double reference_m = 0;           ///< score.reference.
  double range_m = 0;               ///< True, from the middle of the baseline.
};

/// Flies a flight of a data set (scenarios/dataset.h) without bus, log and estimator: every frame
/// that a run of it with `observe: geometric` would score, to the bit.
/// @throws std::invalid_argument unless aircraft 0 carries the only rig, aircraft 1 is the only
/// other one and neither is commanded; ConfigError if a file that the flight names cannot be used.
std::vector<FlownFrame> FlyGeometric(const Scenario& flight);

}  // namespace windhover
