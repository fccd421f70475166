#pragma once

#include <string>

#include <Eigen/Core>

#include "rig/sinusoids.h"

namespace windhover {

/// Samples of an IMU at a constant rate, as recorded in flight.
struct ImuRecording {
  double rate_hz;
  Eigen::MatrixX3d gyro_radps;           ///< One row a sample.
  Eigen::MatrixX3d specific_force_mps2;  ///< Likewise.

  double duration_s() const { return static_cast<double>(gyro_radps.rows()) / rate_hz; }
};

/// Reads CSV with the columns time, three of gyro (rad/s), three of accelerometer (m/s²), in this
/// order unless a header names them otherwise; further columns are ignored. Understands
/// `t_s,gyro_x_rad_s,…` and the EuRoC MAV data set's imu0/data.csv (nanoseconds).
/// @throws ConfigError listing every bad line: not a number, a gap, time that does not rise, a
/// recording below 64 samples.
ImuRecording ReadImuRecording(const std::string& file);

/// The recording turned so that its mean specific force points up, the smallest turn that does
/// it: however the IMU was mounted, the third axis is then vertical. Unchanged where gravity has
/// been taken out (mean below 5 m/s²).
ImuRecording Levelled(ImuRecording recording);

/// Samples at a constant rate as a sum of the sinusoids of their Fourier series from `min_hz` to
/// below half the rate, after mean and linear trend are removed. It equals the so filtered samples
/// at their times, goes on between them, and repeats after the last.
Sinusoids FourierSeries(const Eigen::VectorXd& samples, double rate_hz, double min_hz);

}  // namespace windhover
