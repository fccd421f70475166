#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "common/time/sim_time.h"
#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/detection_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "lcmtypes/uwb_t.hpp"
#include "lcmtypes/velocity_command_t.hpp"
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

/// Aircraft `id` at one tick; null where there is none.
inline const uav_truth_t* Find(const world_truth_t& tick, int id) {
  const auto at =
      std::find_if(tick.uavs.begin(), tick.uavs.end(), [&](auto& uav) { return uav.id == id; });
  return at == tick.uavs.end() ? nullptr : &*at;
}

/// Distance of the centres of two aircraft.
inline double Separation_m(const uav_truth_t& a, const uav_truth_t& b) {
  return (Eigen::Vector3d(a.p_WB_m) - Eigen::Vector3d(b.p_WB_m)).norm();
}

/// One flight as its log tells it.
struct RunRecord {
  Scenario scenario;
  std::string version;  ///< Of the program that flew it.
  bool valid = false;
  std::string invalid_reason;                ///< Empty when valid.
  std::vector<world_truth_t> world;          ///< One a tick, in order of time.
  std::vector<ObserverFrame> frames;         ///< In order of (utime, observer).
  std::vector<velocity_command_t> commands;  ///< In order of (utime, aircraft).
};

}  // namespace windhover
