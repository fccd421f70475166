#include "rig/imu_recording.h"

#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using testing::HasSubstr;

constexpr double kTwoPi = 2 * std::numbers::pi;

// `n` samples at 200 Hz; `time` prints the time of sample i.
template <typename Time>
std::string Recording(int n, const Time& time) {
  std::string text;
  for (int i = 0; i < n; ++i) text += fmt::format("{},0.1,0.2,0.3,1,2,9.8\n", time(i));
  return text;
}

std::string Seconds(int i) { return fmt::format("{:.3f}", 100 + i * 0.005); }

std::string ErrorOf(const std::string& content) {
  const std::string file = test::ScratchFile(content);
  try {
    ReadImuRecording(file);
  } catch (const ConfigError& e) {
    return std::string(e.what()).substr(file.size());
  }
  return "";
}

TEST(ReadImuRecording, ReadsSeconds) {
  const auto recording = ReadImuRecording(test::ScratchFile(
      "t_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,acc_x_m_s2,acc_y_m_s2,acc_z_m_s2\n" +
      Recording(100, Seconds)));
  EXPECT_NEAR(recording.rate_hz, 200, 1e-6);
  EXPECT_EQ(recording.gyro_radps.rows(), 100);
  EXPECT_EQ(recording.gyro_radps.row(7), Eigen::RowVector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(recording.specific_force_mps2.row(7), Eigen::RowVector3d(1, 2, 9.8));
  EXPECT_NEAR(recording.duration_s(), 0.5, 1e-9);
}

TEST(ReadImuRecording, ReadsNanosecondsOfEuroc) {
  const auto recording = ReadImuRecording(test::ScratchFile(
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n" +
      Recording(100, [](int i) { return std::to_string(1403636579758555392 + i * 5000000LL); })));
  EXPECT_NEAR(recording.rate_hz, 200, 1e-3);  // A double holds these times to 256 ns.
}

TEST(ReadImuRecording, HeaderDecidesTheOrder) {
  const auto recording = ReadImuRecording(
      test::ScratchFile("t_s,acc_x,acc_y,acc_z,gyro_x,gyro_y,gyro_z\n" + Recording(64, Seconds)));
  EXPECT_EQ(recording.gyro_radps.row(0), Eigen::RowVector3d(1, 2, 9.8));
}

TEST(ReadImuRecording, ReportsBadLines) {
  const std::string good = Recording(100, Seconds);
  EXPECT_EQ(ErrorOf(good + "100.5,0,0,0,0,0\n"), ":101: must have 7 columns (found 6)");
  EXPECT_EQ(ErrorOf(good + "100.5,0,0,nan,0,0,0\n"),
            ":101: column 4: must be a finite number (found 'nan')");
  EXPECT_EQ(ErrorOf(good + "100.53,0,0,0,0,0,0\n"),
            ":101: gap: 0.035 s after the sample before, the others are 0.005 s apart");
  EXPECT_EQ(ErrorOf(good + "100.49,0,0,0,0,0,0\n100.5,0,0,0,0,0,0\n"),
            ":101: time must rise from line to line (found a step of -0.005 s)");
  EXPECT_EQ(ErrorOf(Recording(63, Seconds)), ": must have at least 64 samples (found 63)");
  EXPECT_EQ(ErrorOf(""), ": must have at least 64 samples (found 0)");
  EXPECT_THAT(ErrorOf(Recording(100, [](int i) { return std::to_string(70 * i); })),
              HasSubstr("time must be in s, ms, us or ns"));
}

TEST(Levelled, TurnsTheMeanUpAndKeepsLengths) {
  ImuRecording recording{200, Eigen::MatrixX3d::Random(100, 3), Eigen::MatrixX3d::Random(100, 3)};
  recording.specific_force_mps2.col(0).array() += 9.8;  // An IMU whose x axis is up, as EuRoC's.
  const ImuRecording level = Levelled(recording);
  EXPECT_NEAR(level.specific_force_mps2.col(0).mean(), 0, 1e-12);
  EXPECT_NEAR(level.specific_force_mps2.col(1).mean(), 0, 1e-12);
  EXPECT_GT(level.specific_force_mps2.col(2).mean(), 9);
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR(level.gyro_radps.row(i).norm(), recording.gyro_radps.row(i).norm(), 1e-12);
    EXPECT_NEAR(level.gyro_radps.row(i).dot(level.specific_force_mps2.row(i)),
                recording.gyro_radps.row(i).dot(recording.specific_force_mps2.row(i)), 1e-12);
  }
}

TEST(Levelled, LeavesARecordingWithoutGravityAlone) {
  const ImuRecording recording{200, Eigen::MatrixX3d::Random(100, 3),
                               Eigen::MatrixX3d::Random(100, 3)};
  EXPECT_EQ(Levelled(recording).specific_force_mps2, recording.specific_force_mps2);
}

TEST(FourierSeries, WorkedExample) {
  Eigen::VectorXd samples(200);  // 1 s at 200 Hz
  for (int i = 0; i < 200; ++i) {
    samples[i] =
        9.8 + 0.5 * std::cos(kTwoPi * 20 * i / 200 + 1) + 3 * std::cos(kTwoPi * 3 * i / 200);
  }
  const Sinusoids signal = FourierSeries(samples, 200, 10);
  ASSERT_EQ(signal.size(), 90u);  // 10 Hz ... 99 Hz
  EXPECT_DOUBLE_EQ(signal.front().frequency_hz, 10);
  EXPECT_DOUBLE_EQ(signal[10].frequency_hz, 20);
  // The straight line that fits the cosines takes under 1 % of them away.
  EXPECT_NEAR(signal[10].amplitude, 0.5, 0.005);
  EXPECT_NEAR(signal[10].phase_rad, 1, 0.01);
}

TEST(FourierSeries, MeanAndTrendDoNotMatter) {
  const Eigen::VectorXd samples = Eigen::VectorXd::Random(200);
  const Eigen::VectorXd drifting = samples.array() + 9.8 + Eigen::ArrayXd::LinSpaced(200, 0, 50);
  const Sinusoids one = FourierSeries(samples, 200, 10), two = FourierSeries(drifting, 200, 10);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(one[i].amplitude, two[i].amplitude, 1e-12);
  }
}

// Noise of every frequency comes back at the samples, but for its mean, trend and Nyquist line.
TEST(FourierSeries, ReproducesNoiseAtTheSamples) {
  const int n = 126;  // 2 · 3² · 7
  Eigen::VectorXd samples(n);
  for (int i = 0; i < n; ++i) samples[i] = std::sin(0.7 * i * i);
  Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(n, -1, 1);
  samples.array() -= samples.mean();
  samples -= time * (time.dot(samples) / time.squaredNorm());
  double nyquist = 0;
  for (int i = 0; i < n; ++i) nyquist += samples[i] * (i % 2 == 0 ? 1 : -1) / n;
  const Sinusoids signal = FourierSeries(samples, 100, 0);
  for (int i = 0; i < n; ++i) {
    EXPECT_NEAR(Value(signal, i / 100.0), samples[i] - nyquist * (i % 2 == 0 ? 1 : -1), 1e-11);
  }
}

// The published figures of this recording: about 1.0, 0.5, 0.7 m/s² rms above 20 Hz.
TEST(ReadImuRecording, ReadsARecordedFlight) {
  const std::string file = WINDHOVER_REAL_INPUTS_DIR "/vibration/euroc_mh01_imu_200hz.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const ImuRecording recording = ReadImuRecording(file);
  EXPECT_NEAR(recording.duration_s(), 60, 0.01);
  const Eigen::Vector3d expected_mps2(1.0, 0.5, 0.7);
  for (int axis = 0; axis < 3; ++axis) {
    const auto signal = FourierSeries(recording.specific_force_mps2.col(axis), 200, 20);
    EXPECT_NEAR(Rms(signal), expected_mps2[axis], 0.1);
  }
}

}  // namespace
}  // namespace windhover
