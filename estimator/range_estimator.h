#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/time/sim_time.h"
#include "lcmtypes/stereo_box_t.hpp"
#include "scenarios/aircraft_config.h"

namespace windhover {

/// Where one detected aircraft is, as one method believes.
struct RangeSolution {
  Eigen::Vector3d p_RT_m;  ///< In the calibrated rig frame R.
  double range_m;          ///< |p_RT|, finite and positive.
  double range_sigma_m;    ///< One standard deviation.
  int n_stages = 0;        ///< Corrections applied.
};

/// A stereo detection, with what the aircraft knows of the moment.
struct StereoObservation {
  stereo_box_t box{};
  Utime utime = 0;
  int track_id = 0;  ///< The same for sightings of the same target (estimator/tracker.h).
  Eigen::Matrix3d R_WR = Eigen::Matrix3d::Identity();  ///< By its own navigation.
  Eigen::Vector3d v_WR_mps = Eigen::Vector3d::Zero();  ///< Of the rig, in W.
};

/// One way to get distances from the stereo detections of one rig. Sees no bus and no truth. It
/// may keep what it learned of rig and targets: it must see observations in order of time.
class RangeEstimator {
 public:
  virtual ~RangeEstimator() = default;

  /// The distance of the aircraft in `observation`, or nothing if the boxes allow none (no
  /// parallax, no size, not a number).
  std::optional<RangeSolution> Estimate(const StereoObservation& observation);

 private:
  /// May return what is not a distance; Estimate() withholds it.
  virtual std::optional<RangeSolution> Solve(const StereoObservation& observation) = 0;
};

/// The estimator that scenarios call `method` (interfaces: `estimator.methods`).
/// @throws std::invalid_argument for a name that is none.
std::unique_ptr<RangeEstimator> MakeRangeEstimator(const std::string& method,
                                                   const AircraftConfig& config);

}  // namespace windhover
