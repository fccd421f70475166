#include "rig/base_vibration.h"

#include <fmt/format.h>

#include "common/config/fields.h"
#include "rig/imu_recording.h"
#include "rig/power_spectrum.h"

namespace windhover {
namespace {

// Bins of a synthesised axis: fine enough for a resonance of 1 % damping, which is 6 bins wide.
constexpr int kBins = 512, kRateBins = 128;
constexpr std::array<const char*, 3> kAxisNames = {"forward", "left", "up"};

void Scale(Sinusoids* signal, double factor) {
  for (Sinusoid& line : *signal) line.amplitude *= factor;
}

BaseVibration FromSpectrum(const VibrationConfig& config, std::uint64_t seed,
                           const std::string& name) {
  const PowerSpectrum spectrum = config.file.empty()
                                     ? PowerSpectrum::SmallMultirotorFloor()
                                     : PowerSpectrum::FromFile(config.file.absolute);
  const auto make = [&](const char* kind, int axis, int n_bins) {
    const std::string purpose = fmt::format("{}/vibration/{}/{}", name, kind, kAxisNames[axis]);
    return spectrum.Synthesize(config.min_hz, n_bins, RandomStream(seed, purpose));
  };
  BaseVibration vibration;
  for (int axis = 0; axis < 3; ++axis) {
    vibration.acceleration_mps2[axis] = make("acceleration", axis, kBins);
    Scale(&vibration.acceleration_mps2[axis], config.axis_ratio[axis]);
    // No spectrum of angular rates is given: it is taken to have the shape of the acceleration's.
    Sinusoids& rate = vibration.angular_rate_radps[axis];
    rate = make("angular_rate", axis, kRateBins);
    if (!rate.empty()) Scale(&rate, config.angular_rate_rms_radps / Rms(rate));
  }
  return vibration;
}

BaseVibration FromRecording(const VibrationConfig& config) {
  if (config.file.empty()) {
    throw ConfigError("vibration.file: must name an IMU recording where source is recorded");
  }
  const ImuRecording recording = Levelled(ReadImuRecording(config.file.absolute));
  if (recording.rate_hz / 2 <= config.min_hz || recording.duration_s() * config.min_hz < 1) {
    throw ConfigError(fmt::format(
        "{}: {:.3g} s at {:.4g} Hz: must be longer than a period of vibration.min_hz = {:g} and "
        "have more than twice its rate",
        config.file.absolute, recording.duration_s(), recording.rate_hz, config.min_hz));
  }
  BaseVibration vibration;
  for (int axis = 0; axis < 3; ++axis) {
    vibration.acceleration_mps2[axis] =
        FourierSeries(recording.specific_force_mps2.col(axis), recording.rate_hz, config.min_hz);
    vibration.angular_rate_radps[axis] =
        FourierSeries(recording.gyro_radps.col(axis), recording.rate_hz, config.min_hz);
  }
  const Sinusoids& lines = vibration.acceleration_mps2[0];
  if (lines.size() > 1) {
    vibration.line_spacing_hz = (lines.back().frequency_hz - lines.front().frequency_hz) /
                                static_cast<double>(lines.size() - 1);
  }
  return vibration;
}

}  // namespace

BaseVibration MakeBaseVibration(const VibrationConfig& config, std::uint64_t seed,
                                const std::string& name) {
  if (config.source == VibrationSource::kNone || config.level == 0) return {};
  BaseVibration vibration = config.source == VibrationSource::kPsd
                                ? FromSpectrum(config, seed, name)
                                : FromRecording(config);
  for (int axis = 0; axis < 3; ++axis) {
    Scale(&vibration.acceleration_mps2[axis], config.level);
    Scale(&vibration.angular_rate_radps[axis], config.level);
  }
  return vibration;
}

}  // namespace windhover
