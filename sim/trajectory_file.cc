#include "sim/trajectory_file.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/table/number_table.h"

namespace windhover {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr int kTumColumns = 8;

// Time steps of EuRoC are absurd in seconds: 10⁴ ns is 10 us, 10⁴ s is three hours.
bool IsEuroc(const NumberTable& table) {
  if (table.rows.size() < 2) return false;
  const double length = table.rows.back().values[0] - table.rows.front().values[0];
  return std::abs(length) / static_cast<double>(table.rows.size() - 1) >= 1e4;
}

Quaterniond QuaternionOf(const std::vector<double>& values, bool is_euroc) {
  const double* const q = &values[4];
  return is_euroc ? Quaterniond(q[0], q[1], q[2], q[3]) : Quaterniond(q[3], q[0], q[1], q[2]);
}

// Rotation from the body to the sensor whose world-up direction, in sensor axes, is on average
// `up`.
Matrix3d SensorFromBody(const Vector3d& up) {
  int axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  const Vector3d body_up = Vector3d::Unit(axis) * (up[axis] < 0 ? -1 : 1);
  const Vector3d body_forward = axis == 2 ? Vector3d::UnitX() : Vector3d::UnitZ();
  Matrix3d R;
  R << body_forward, body_up.cross(body_forward), body_up;
  return R;
}

void TurnToBodyAxes(std::vector<RecordedPose>* poses) {
  Vector3d up = Vector3d::Zero();
  for (const RecordedPose& pose : *poses) up += pose.q.conjugate() * Vector3d::UnitZ();
  const Quaterniond sensor_from_body(SensorFromBody(up));
  for (RecordedPose& pose : *poses) pose.q = (pose.q * sensor_from_body).normalized();
}

}  // namespace

std::vector<RecordedPose> ReadTrajectoryFile(const std::string& file) {
  constexpr double kLeastQuaternion = 0.1;
  FileFindings findings(file);
  const NumberTable table = ReadNumberTable(file, kTumColumns, /*more_allowed=*/true, &findings);
  const bool is_euroc = IsEuroc(table);
  const double unit_s = is_euroc ? 1e-9 : 1;
  if (!is_euroc && !table.rows.empty() && table.rows.front().values.size() > kTumColumns) {
    findings.Add(table.rows.front().line,
                 fmt::format("must have 8 columns, t x y z qx qy qz qw (found {})",
                             table.rows.front().values.size()));
  }
  std::vector<RecordedPose> poses;
  for (const auto& [line, values] : table.rows) {
    const Quaterniond q = QuaternionOf(values, is_euroc);
    const double t_s = (values[0] - table.rows.front().values[0]) * unit_s;
    if (!poses.empty() && !(t_s > poses.back().t_s)) {
      findings.Add(line, fmt::format("time must rise from line to line (found a step of {:g} s)",
                                     t_s - poses.back().t_s));
    } else if (q.norm() < kLeastQuaternion) {
      findings.Add(line, fmt::format("must have a quaternion of length 1 (found {:g})", q.norm()));
    } else {
      poses.push_back({t_s, Vector3d(values[1], values[2], values[3]), q.normalized()});
    }
  }
  if (findings.empty() && poses.size() < 2) {
    findings.Add(
        fmt::format("must have at least 2 poses, TUM (t x y z qx qy qz qw) or EuRoC "
                    "(ns,px,py,pz,qw,qx,qy,qz) (found {})",
                    poses.size()));
  }
  findings.ThrowIfAny();
  if (HasAttitude(poses)) TurnToBodyAxes(&poses);
  return poses;
}

bool HasAttitude(const std::vector<RecordedPose>& poses) {
  return std::any_of(poses.begin(), poses.end(), [&](const RecordedPose& pose) {
    return pose.q.angularDistance(poses.front().q) > 1e-6;
  });
}

}  // namespace windhover
