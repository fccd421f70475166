#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

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

/// One way to get a distance from a stereo detection. Sees no bus and no truth; keeps no state.
class RangeEstimator {
 public:
  virtual ~RangeEstimator() = default;

  /// The distance of the aircraft in `box`, or nothing if the boxes allow none (no parallax, no
  /// size, not a number).
  std::optional<RangeSolution> Estimate(const stereo_box_t& box) const;

 private:
  /// May return what is not a distance; Estimate() withholds it.
  virtual std::optional<RangeSolution> Solve(const stereo_box_t& box) const = 0;
};

/// The estimator that scenarios call `method` (interfaces: `estimator.methods`).
/// @throws std::invalid_argument for a name that is none.
std::unique_ptr<RangeEstimator> MakeRangeEstimator(const std::string& method,
                                                   const AircraftConfig& config);

}  // namespace windhover
