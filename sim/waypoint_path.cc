#include <algorithm>
#include <cmath>

#include "common/geometry/rotation.h"
#include "sim/flatness.h"
#include "sim/path.h"

namespace windhover {
namespace {

// Slope at an inner point between steps h0 and h1 with slopes d0 and d1: their weighted harmonic
// mean, 0 at a turning point.
double MonotoneSlope(double h0, double h1, double d0, double d1) {
  if (d0 * d1 <= 0) return 0;
  const double w0 = 2 * h1 + h0, w1 = h1 + 2 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

}  // namespace

WaypointPath::WaypointPath(const std::vector<Waypoint>& waypoints) {
  for (const Waypoint& waypoint : waypoints) {
    const auto& [x_m, y_m, z_m] = waypoint.position_m;
    double yaw_rad = RadFromDeg(waypoint.yaw_deg);
    if (!poses_.empty()) {
      const double last_rad = poses_.back()[3];
      yaw_rad = last_rad + std::remainder(yaw_rad - last_rad, 2 * EIGEN_PI);
    }
    times_s_.push_back(waypoint.time_s);
    poses_.emplace_back(x_m, y_m, z_m, yaw_rad);
  }
  for (std::size_t i = 0; i < poses_.size(); ++i) slopes_.push_back(SlopeAt(i));
}

WaypointPath::Pose WaypointPath::SlopeAt(std::size_t i) const {
  Pose slope = Pose::Zero();
  if (i == 0 || i + 1 == poses_.size()) return slope;
  const double h0 = times_s_[i] - times_s_[i - 1], h1 = times_s_[i + 1] - times_s_[i];
  const Pose d0 = (poses_[i] - poses_[i - 1]) / h0, d1 = (poses_[i + 1] - poses_[i]) / h1;
  for (int axis = 0; axis < 4; ++axis) slope[axis] = MonotoneSlope(h0, h1, d0[axis], d1[axis]);
  return slope;
}

Kinematics WaypointPath::At(double t_s) const {
  Pose value, first = Pose::Zero(), second = Pose::Zero(), third = Pose::Zero();
  if (t_s <= times_s_.front() || t_s >= times_s_.back()) {
    value = t_s <= times_s_.front() ? poses_.front() : poses_.back();
  } else {
    const auto after = std::upper_bound(times_s_.begin(), times_s_.end(), t_s);
    const std::size_t j = static_cast<std::size_t>(after - times_s_.begin()), i = j - 1;
    const double h = times_s_[j] - times_s_[i], s = (t_s - times_s_[i]) / h;
    // The quintic with these end values and slopes and no curvature at its ends.
    const Pose step = poses_[j] - poses_[i], v0 = h * slopes_[i], v1 = h * slopes_[j];
    const Pose c3 = 10 * step - 6 * v0 - 4 * v1, c4 = -15 * step + 8 * v0 + 7 * v1,
               c5 = 6 * step - 3 * v0 - 3 * v1;
    value = poses_[i] + s * (v0 + s * s * (c3 + s * (c4 + s * c5)));
    first = (v0 + s * s * (3 * c3 + s * (4 * c4 + s * 5 * c5))) / h;
    second = s * (6 * c3 + s * (12 * c4 + s * 20 * c5)) / (h * h);
    third = (6 * c3 + s * (24 * c4 + s * 60 * c5)) / (h * h * h);
  }
  Kinematics state;
  state.p_WB_m = value.head<3>();
  state.v_WB_mps = first.head<3>();
  state.a_WB_mps2 = second.head<3>();
  SetAttitude(third.head<3>(), value[3], first[3], &state);
  return state;
}

}  // namespace windhover
