#pragma once

#include <array>
#include <memory>
#include <vector>

#include "scenarios/scenario.h"
#include "sim/cubic_spline.h"
#include "sim/kinematics.h"
#include "sim/trajectory_file.h"

namespace windhover {

/// A prescribed flight, known at any time.
class Path {
 public:
  virtual ~Path() = default;
  virtual Kinematics At(double t_s) const = 0;
};

/// Stays where it is, level.
class HoldPath : public Path {
 public:
  HoldPath(const Eigen::Vector3d& p_WB_m, double yaw_rad);
  Kinematics At(double t_s) const override;

 private:
  Kinematics state_;
};

/// Passes through waypoints: rests until the first and after the last, turns back without
/// overshoot, attitude from the acceleration. Position, velocity and acceleration are continuous:
/// quintic between waypoints, no acceleration at them, velocities there as chosen by F. N. Fritsch
/// & R. E. Carlson, "Monotone piecewise cubic interpolation", SINUM 1980. Heading takes the
/// shorter way round.
class WaypointPath : public Path {
 public:
  /// @pre at least one waypoint, times rising.
  explicit WaypointPath(const std::vector<Waypoint>& waypoints);
  Kinematics At(double t_s) const override;

 private:
  using Pose = Eigen::Vector4d;  // x, y, z, yaw

  Pose SlopeAt(std::size_t i) const;

  std::vector<double> times_s_;
  std::vector<Pose> poses_;
  std::vector<Pose> slopes_;
};

/// A recorded flight: positions by a natural cubic spline, recorded attitude by spherical linear
/// interpolation; attitude from the acceleration where the recording has none.
class RecordedPath : public Path {
 public:
  /// @throws ConfigError if the file cannot be used or ends before `end_s` of simulated time.
  RecordedPath(const TrajectoryConfig& config, double end_s);
  Kinematics At(double t_s) const override;

 private:
  void SetRecordedAttitude(double recorded_s, Kinematics* state) const;

  TrajectoryConfig config_;
  Eigen::Quaterniond turn_;  // About W's z.
  std::vector<RecordedPose> poses_;
  bool has_attitude_;
  CubicSpline positions_;
};

/// The path of an aircraft that flies by itself until `end_s`; null for one that is commanded.
/// @throws ConfigError if its trajectory file cannot be used.
std::unique_ptr<Path> MakePath(const Aircraft& aircraft, double end_s);

}  // namespace windhover
