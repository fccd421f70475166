#pragma once

#include <memory>
#include <vector>

#include "estimator/range_estimator.h"
#include "estimator/tracker.h"
#include "lcmtypes/nav_state_t.hpp"
#include "lcmtypes/range_t.hpp"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Every method that `config` lists for one rig, with what they remember of a flight.
class RigEstimators {
 public:
  explicit RigEstimators(const AircraftConfig& config);

  /// RANGE of the aircraft `nav.id`: an estimate of every method for every box, sorted by box,
  /// then by method. @pre `utime` grows from call to call.
  range_t Estimate(Utime utime, const nav_state_t& nav, const std::vector<stereo_box_t>& boxes);

 private:
  StereoObservation ObservedBy(const nav_state_t& nav) const;

  std::vector<std::string> methods_;
  StereoRig rig_;
  Eigen::Isometry3d X_BR_;
  Tracker tracker_;
  std::vector<std::unique_ptr<RangeEstimator>> estimators_;  ///< As methods_.
};

}  // namespace windhover
