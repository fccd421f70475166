#pragma once

#include "sim/kinematics.h"

namespace windhover {

/// Attitude of a multirotor that accelerates with a_WB_mps2: its thrust, along B's z, carries that
/// and its weight, and B's x points as near to heading `yaw_rad` (0 is east) as it can. Fills
/// q_WB and w_WB_B_radps.
///
/// `jerk_mps3` is the derivative of the acceleration, in W. Source: D. Mellinger & V. Kumar,
/// "Minimum snap trajectory generation and control for quadrotors", ICRA 2011.
/// @pre the acceleration is not gravity's (free fall has no attitude).
void SetAttitude(const Eigen::Vector3d& jerk_mps3, double yaw_rad, double yaw_rate_radps,
                 Kinematics* state);

}  // namespace windhover
