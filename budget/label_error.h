#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "scenarios/scenario.h"

namespace windhover {

/// How far a UWB label is off the range from the rig, in one flight: the model of
/// sim/uwb_ranging.h for one target that passes by, without the order in which its samples come.
/// At every instant the target faces another way, and stands in the way of its radio or not. A
/// stamp that jitters does not change which samples are nearest to an image.
class LabelError {
 public:
  LabelError(const Scenario& scenario, std::uint64_t seed);

  /// Label minus range, m, at `t_s` of the flight; 0 where the score is not held against UWB.
  /// `p_RT_m` and `v_mps`: of the target, in the rig's axes.
  double At_m(int instant, double t_s, const Eigen::Vector3d& p_RT_m,
              const Eigen::Vector3d& v_mps) const;

 private:
  bool is_used_;
  UwbConfig uwb_;
  std::uint64_t seed_;
  Eigen::Vector3d observer_R_m_;  ///< Antenna of the observer, in the rig frame.
  Eigen::Vector3d up_R_;
  double target_up_m_, target_out_m_;  ///< Antenna of the target above and off its axis.
  double delay_m_, latency_s_;         ///< Of this flight.
  double own_ppm_, target_ppm_;        ///< Of this flight's radios.
};

/// The observer's antenna in the rig frame, m.
Eigen::Vector3d AntennaInRig_m(const Scenario& scenario);

/// The target's antenna in its body frame, m.
Eigen::Vector3d AntennaOfTarget_m(const Scenario& scenario);

/// Up, in the axes of the rig of a level aircraft.
Eigen::Vector3d UpInRig(const Scenario& scenario);

}  // namespace windhover
