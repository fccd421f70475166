#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace windhover {

/// One pose of a recording; times count from its first.
struct RecordedPose {
  double t_s;
  Eigen::Vector3d p_m;
  Eigen::Quaterniond q;  ///< Body (forward-left-up) to world (up is z), normalised.
};

/// Reads a recorded path of at least two poses, in the format
///
///  * TUM: `t x y z qx qy qz qw`, seconds; or
///  * EuRoC: `ns,px,py,pz,qw,qx,qy,qz,…`, nanoseconds, further columns ignored;
///
/// told apart by their columns and units of time. Recordings give the attitude of whatever sensor
/// they have: a body forward-left-up or forward-right-down, a camera, an IMU lying on its side.
/// The sensor axis that on average points most upwards is taken for the body's up; its forward is
/// the sensor's x axis where up is ±z, else the sensor's z axis, a camera's line of sight.
/// @throws ConfigError listing every bad line as file:line: what.
std::vector<RecordedPose> ReadTrajectoryFile(const std::string& file);

/// Whether the recording turns at all; one without attitude holds the same rotation throughout.
bool HasAttitude(const std::vector<RecordedPose>& poses);

}  // namespace windhover
