#pragma once

#include <deque>

#include "sim/kinematics.h"

namespace windhover {

/// Where a body has been, for what is measured now of a moment that is over.
class StateHistory {
 public:
  /// Replaces what was added for the same time. @pre t_s does not fall from call to call.
  void Add(double t_s, const Kinematics& state);

  /// Forgets what At() does not need from `t_s` on.
  void ForgetBefore(double t_s);

  /// Pose at `t_s`: position by the cubic through the neighbours' positions and velocities,
  /// attitude by spherical linear interpolation; outside of what is known, the nearest state
  /// carried on with its velocity. Only p_WB_m, v_WB_mps and q_WB are filled.
  /// @pre something was added.
  Kinematics At(double t_s) const;

 private:
  struct Entry {
    double t_s;
    Kinematics state;
  };

  std::deque<Entry> entries_;
};

}  // namespace windhover
