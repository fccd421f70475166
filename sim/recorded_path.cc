#include <algorithm>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "common/geometry/rotation.h"
#include "sim/flatness.h"
#include "sim/path.h"

namespace windhover {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

CubicSpline SplineThrough(const std::vector<RecordedPose>& poses) {
  std::vector<double> times_s;
  std::vector<Vector3d> points_m;
  for (const RecordedPose& pose : poses) {
    times_s.push_back(pose.t_s);
    points_m.push_back(pose.p_m);
  }
  return CubicSpline(std::move(times_s), std::move(points_m));
}

// Heading of B's x axis.
double YawOf(const Quaterniond& q_WB) {
  const Vector3d forward = q_WB * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

}  // namespace

RecordedPath::RecordedPath(const TrajectoryConfig& config, double end_s)
    : config_(config),
      turn_(Eigen::AngleAxisd(RadFromDeg(config.yaw_deg), Vector3d::UnitZ())),
      poses_(ReadTrajectoryFile(config.file.absolute)),
      has_attitude_(HasAttitude(poses_)),
      positions_(SplineThrough(poses_)) {
  constexpr double kRounding_s = 1e-6;
  const double needed_s = config.start_s + end_s * config.speed, has_s = poses_.back().t_s;
  if (needed_s <= has_s + kRounding_s) return;
  throw ConfigError(
      fmt::format("{}: trajectory.file: must be a recording of at least {:.6g} s, which is start_s "
                  "+ duration · "
                  "speed (found {:.6g} s in '{}')",
                  config.file.where, needed_s, has_s, config.file.as_given));
}

Kinematics RecordedPath::At(double t_s) const {
  const double speed = config_.speed, recorded_s = config_.start_s + t_s * speed;
  const CubicSpline::Sample recorded = positions_.At(recorded_s);
  Kinematics state;
  const auto to_world = [&](const Vector3d& v) -> Vector3d { return turn_ * (config_.scale * v); };
  state.p_WB_m = to_world(recorded.value) + Vector3d(config_.offset_m.data());
  state.v_WB_mps = speed * to_world(recorded.first);
  state.a_WB_mps2 = speed * speed * to_world(recorded.second);
  if (has_attitude_) {
    SetRecordedAttitude(recorded_s, &state);
  } else {
    SetAttitude(speed * speed * speed * to_world(recorded.third), YawOf(turn_ * poses_.front().q),
                0, &state);
  }
  return state;
}

void RecordedPath::SetRecordedAttitude(double recorded_s, Kinematics* state) const {
  const auto after = std::upper_bound(poses_.begin() + 1, poses_.end() - 1, recorded_s,
                                      [](double t, const RecordedPose& p) { return t < p.t_s; });
  const RecordedPose& end = *after;
  const RecordedPose& begin = *(after - 1);
  const double h = end.t_s - begin.t_s;
  state->q_WB = (turn_ * begin.q.slerp((recorded_s - begin.t_s) / h, end.q)).normalized();
  Quaterniond step = begin.q.conjugate() * end.q;
  if (step.w() < 0) step.coeffs() = -step.coeffs();  // slerp takes the shorter way, too.
  const Eigen::AngleAxisd turn(step);
  state->w_WB_B_radps = turn.axis() * (turn.angle() * config_.speed / h);
}

}  // namespace windhover
