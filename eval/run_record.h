#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/time/sim_time.h"
#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/uwb_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// All that one stereo rig saw and said at one time.
struct ObserverFrame {
  Utime utime = 0;
  int observer_id = 0;
  annotation_t truth{};                   ///< Targets sorted by id.
  std::optional<detection_t> detections;  ///< Nothing: the message is missing.
  std::optional<range_t> ranges;
  std::map<int, double> uwb_m;  ///< Range from the observer's antenna, by target id.
};

/// One flight as its log tells it.
struct RunRecord {
  Scenario scenario;
  std::string version;  ///< Of the program that flew it.
  bool valid = false;
  std::string invalid_reason;         ///< Empty when valid.
  std::vector<world_truth_t> world;   ///< One a tick.
  std::vector<ObserverFrame> frames;  ///< In order of (utime, observer).
};

}  // namespace windhover
