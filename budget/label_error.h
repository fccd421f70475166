#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "scenarios/scenario.h"

namespace windhover {

/// How far a UWB label is off the range from the rig, of one flight: bias, noise, antenna delay,
/// the lever between antenna and rig, and the way a moving target makes in the label's latency.
/// NLOS, outliers and clock errors, which are
/// of radios and not of the rig, are left out (sim/uwb_ranging.h has them).
class LabelError {
 public:
  LabelError(const Scenario& scenario, std::uint64_t seed);

  /// Label minus range, m; 0 where the score is not held against UWB. `p_RT_m` and `v_mps`: of the
  /// target, in the rig's axes.
  double At_m(int instant, const Eigen::Vector3d& p_RT_m, const Eigen::Vector3d& v_mps) const;

 private:
  bool is_used_;
  UwbConfig uwb_;
  std::uint64_t seed_;
  Eigen::Vector3d antenna_R_m_;  ///< Of the observer, in the rig frame.
  double delay_m_, latency_s_;   ///< Of this flight.
};

/// The observer's antenna in the rig frame, m.
Eigen::Vector3d AntennaInRig_m(const Scenario& scenario);

}  // namespace windhover
