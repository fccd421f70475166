#include "rig/base_vibration.h"

#include <utility>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "rig/imu_recording.h"
#include "rig/isolator.h"
#include "rig/power_spectrum.h"

namespace windhover {
namespace {

// Bins of a synthesised axis: fine enough for a resonance of 1 % damping, which is 6 bins wide.
constexpr int kBins = 512, kRateBins = 128;
constexpr std::array<const char*, 3> kAxisNames = {"forward", "left", "up"};

void Scale(Sinusoids* signal, double factor) {
  for (Sinusoid& line : *signal) line.amplitude *= factor;
}

PowerSpectrum SpectrumOf(const VibrationConfig& config) {
  if (!config.file.empty()) return PowerSpectrum::FromFile(config.file.absolute);
  return config.preset == VibrationPreset::kMilStd810hCat24 ? PowerSpectrum::MilStd810hCategory24()
                                                            : PowerSpectrum::SmallMultirotorFloor();
}

BaseVibration FromSpectrum(const VibrationConfig& config, std::uint64_t seed,
                           const std::string& name) {
  const PowerSpectrum spectrum = SpectrumOf(config);
  if (spectrum.Power_g2(config.min_hz, 1e9) == 0) {
    throw ConfigError(fmt::format(
        "{}: must reach above vibration.min_hz = {:g}",
        config.file.absolute.empty() ? "vibration.preset" : config.file.absolute, config.min_hz));
  }
  const PresetFactors factors = FactorsOf(config.preset);
  const auto make = [&](const char* kind, int axis, int n_bins) {
    const std::string purpose = fmt::format("{}/vibration/{}/{}", name, kind, kAxisNames[axis]);
    return spectrum.Synthesize(config.min_hz, n_bins, RandomStream(seed, purpose));
  };
  BaseVibration vibration;
  for (int axis = 0; axis < 3; ++axis) {
    vibration.acceleration_mps2[axis] = make("acceleration", axis, kBins);
    Scale(&vibration.acceleration_mps2[axis],
          config.axis_ratio[axis] * (config.file.empty() ? factors.floor : 1));
    // Rotors turn the body with their tones.
    if (config.source == VibrationSource::kRotors) continue;
    // No spectrum of angular rates is given: it is taken to have the shape of the acceleration's.
    Sinusoids& rate = vibration.angular_rate_radps[axis];
    rate = make("angular_rate", axis, kRateBins);
    Scale(&rate, config.angular_rate_rms_radps * factors.angular_rate / Rms(rate));
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
  return vibration;
}

}  // namespace

PresetFactors FactorsOf(VibrationPreset preset) {
  switch (preset) {
    case VibrationPreset::kCalm:
      return {.tones = 0.25, .floor = 0.35, .angular_rate = 0.3};
    case VibrationPreset::kRough:
      return {.tones = 4, .floor = 3, .angular_rate = 3};
    case VibrationPreset::kNormal:
    case VibrationPreset::kMilStd810hCat24:  // Has a spectrum of its own.
      break;
  }
  return {.tones = 1, .floor = 1, .angular_rate = 1};
}

BaseVibration MakeBaseVibration(const VibrationConfig& config, std::uint64_t seed,
                                const std::string& name) {
  if (config.source == VibrationSource::kNone || config.level == 0) return {};
  BaseVibration vibration = config.source == VibrationSource::kRecorded
                                ? FromRecording(config)
                                : FromSpectrum(config, seed, name);
  const auto through_isolator = [&](double frequency_hz) {
    return config.level * Transmissibility(config.isolator, frequency_hz);
  };
  for (int axis = 0; axis < 3; ++axis) {
    Sinusoids& acceleration = vibration.acceleration_mps2[axis];
    Sinusoids& rate = vibration.angular_rate_radps[axis];
    acceleration = Filtered(std::move(acceleration), through_isolator);
    rate = Filtered(std::move(rate), through_isolator);
  }
  return vibration;
}

}  // namespace windhover
