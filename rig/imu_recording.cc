#include "rig/imu_recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <unsupported/Eigen/FFT>

#include "common/table/number_table.h"

namespace windhover {
namespace {

constexpr int kMinSamples = 64;

// Where the seven numbers of a sample stand in a row: time, gyro x y z, accelerometer x y z.
using Columns = std::array<int, 7>;

bool Contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

// By the names of the header if it names three of each, else in the usual order.
Columns FindColumns(const std::vector<std::string>& header) {
  std::vector<int> gyro, acceleration;
  for (int i = 0; i < static_cast<int>(header.size()); ++i) {
    const std::string& name = header[i];
    if (Contains(name, "gyro") || name.starts_with("w_")) gyro.push_back(i);
    if (Contains(name, "acc") || name.starts_with("a_")) acceleration.push_back(i);
  }
  if (gyro.size() != 3 || acceleration.size() != 3) return {0, 1, 2, 3, 4, 5, 6};
  return {0, gyro[0], gyro[1], gyro[2], acceleration[0], acceleration[1], acceleration[2]};
}

// Seconds per unit of time, judged by the interval between samples: IMUs have 20 Hz to 10 kHz, so
// that intervals in s, ms, us and ns do not overlap. Nothing if it is none of these.
std::optional<double> TimeUnit_s(double interval) {
  for (const double unit_s : {1.0, 1e-3, 1e-6, 1e-9}) {
    const double interval_s = interval * unit_s;
    if (interval_s >= 0.99e-4 && interval_s <= 0.0501) return unit_s;
  }
  return std::nullopt;
}

double MedianInterval(const NumberTable& table) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    intervals.push_back(table.rows[i].values[0] - table.rows[i - 1].values[0]);
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

void CheckIntervals(const NumberTable& table, double interval, double unit_s,
                    FileFindings* findings) {
  double last = table.rows.front().values[0];
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    const auto& [line, values] = table.rows[i];
    const double step = values[0] - last;
    if (!(step > 0)) {
      findings->Add(line, fmt::format("time must rise from line to line (found a step of {:g} s)",
                                      step * unit_s));
      continue;
    }
    if (step > 1.5 * interval) {
      findings->Add(line, fmt::format("gap: {:g} s after the sample before, the others are {:g} s "
                                      "apart",
                                      step * unit_s, interval * unit_s));
    }
    last = values[0];
  }
}

// The largest number up to n that the FFT takes in small steps: no prime factor above 7.
int FastLength(int n) {
  for (;; --n) {
    int rest = n;
    for (const int prime : {2, 3, 5, 7}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return n;
  }
}

Eigen::VectorXd Detrended(const Eigen::VectorXd& samples) {
  const auto n = samples.size();
  const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(n, -1, 1);
  const double mean = samples.mean();
  const double slope = time.dot(samples) / time.squaredNorm();
  return samples.array() - mean - slope * time.array();
}

}  // namespace

ImuRecording ReadImuRecording(const std::string& file) {
  FileFindings findings(file);
  const NumberTable table = ReadNumberTable(file, 7, /*more_allowed=*/true, &findings);
  const int n = static_cast<int>(table.rows.size());
  if (findings.empty() && n < kMinSamples) {
    findings.Add(fmt::format("must have at least {} samples (found {})", kMinSamples, n));
  }
  findings.ThrowIfAny();

  const double interval = MedianInterval(table);
  const auto unit_s = TimeUnit_s(std::abs(interval));
  if (!unit_s) {
    findings.Add(
        fmt::format("time must be in s, ms, us or ns, at 20 Hz to 10 kHz (found steps of "
                    "{:g})",
                    interval));
  } else {
    CheckIntervals(table, std::abs(interval), *unit_s, &findings);
  }
  findings.ThrowIfAny();

  const Columns columns = FindColumns(table.header);
  const double length = table.rows.back().values[0] - table.rows.front().values[0];
  ImuRecording recording{(n - 1) / (length * *unit_s), Eigen::MatrixX3d(n, 3),
                         Eigen::MatrixX3d(n, 3)};
  for (int i = 0; i < n; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      recording.gyro_radps(i, axis) = table.rows[i].values[columns[1 + axis]];
      recording.specific_force_mps2(i, axis) = table.rows[i].values[columns[4 + axis]];
    }
  }
  return recording;
}

ImuRecording Levelled(ImuRecording recording) {
  constexpr double kLeastGravity_mps2 = 5;
  const Eigen::Vector3d mean_mps2 = recording.specific_force_mps2.colwise().mean();
  if (mean_mps2.norm() < kLeastGravity_mps2) return recording;
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(mean_mps2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  recording.gyro_radps *= turn.transpose();
  recording.specific_force_mps2 *= turn.transpose();
  return recording;
}

Sinusoids FourierSeries(const Eigen::VectorXd& samples, double rate_hz, double min_hz) {
  const int n = FastLength(static_cast<int>(samples.size()));
  const Eigen::VectorXd detrended = Detrended(samples.head(n));
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> spectrum;
  fft.fwd(spectrum, std::vector<double>(detrended.data(), detrended.data() + n));

  Sinusoids signal;
  for (int k = 1; 2 * k < n; ++k) {
    const double frequency_hz = k * rate_hz / n;
    if (frequency_hz < min_hz) continue;
    signal.push_back({frequency_hz, 2 * std::abs(spectrum[k]) / n, std::arg(spectrum[k])});
  }
  return signal;
}

}  // namespace windhover
