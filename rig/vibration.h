#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

enum class VibrationSource { kNone, kRotors, kPsd, kRecorded };
template <>
inline constexpr EnumNames<VibrationSource> kEnumNames<VibrationSource>{
    {VibrationSource::kNone, "none"},
    {VibrationSource::kRotors, "rotors"},
    {VibrationSource::kPsd, "psd"},
    {VibrationSource::kRecorded, "recorded"}};

/// How much an aircraft shakes: its tones and its broadband floor.
enum class VibrationPreset { kCalm, kNormal, kRough, kMilStd810hCat24 };
template <>
inline constexpr EnumNames<VibrationPreset> kEnumNames<VibrationPreset>{
    {VibrationPreset::kCalm, "calm"},
    {VibrationPreset::kNormal, "normal"},
    {VibrationPreset::kRough, "rough"},
    {VibrationPreset::kMilStd810hCat24, "mil_std_810h_cat24"}};

/// Vertical acceleration of the bar's root by one rotor: amplitudes of the tones at one, two
/// (blade pass) and four times its speed, when it turns at `reference_hz`. They go with the square
/// of the speed, as imbalance and thrust do. The level is an assumption within ArduPilot's limits
/// ("Measuring Vibration": standard deviation below 15 m/s² is normal, above 60 bad).
struct RotorToneConfig {
  double a_1p_mps2 = 0.5, a_2p_mps2 = 2.0, a_4p_mps2 = 0.7;
  double reference_hz = 50;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("a_1p_mps2", a_1p_mps2, InRange{0, 1000}, "amplitude at the rotor's speed");
    v.Field("a_2p_mps2", a_2p_mps2, InRange{0, 1000}, "amplitude at twice that, blade pass");
    v.Field("a_4p_mps2", a_4p_mps2, InRange{0, 1000}, "amplitude at four times that");
    v.Field("reference_hz", reference_hz, InRange{1, 1000}, "speed at which these are reached");
  }
};

/// Soft mounts between the airframe and the bar's root.
struct IsolatorConfig {
  bool enabled = false;
  double frequency_hz = 12;
  double damping = 0.15;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("enabled", enabled, AnyBool{}, "whether the bar stands on soft mounts");
    v.Field("frequency_hz", frequency_hz, InRange{1, 1000}, "natural frequency on the mounts");
    v.Field("damping", damping, InRange{0.001, 10}, "damping ratio of the mounts");
  }
};

/// Vibration at the root of the bar.
struct VibrationConfig {
  VibrationSource source = VibrationSource::kNone;
  VibrationPreset preset = VibrationPreset::kNormal;
  InputFile file;  ///< IMU recording (CSV) when source is recorded; PSD (CSV) otherwise, optional.
  double level = 1;
  std::array<double, 3> axis_ratio = {0.3, 0.3, 1.0};
  double angular_rate_rms_radps = 0.05;
  double min_hz = 10;
  RotorToneConfig rotors;
  IsolatorConfig isolator;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("source", source, AnyEnum{}, "where the vibration comes from");
    v.Field("preset", preset, AnyEnum{}, "rotors, psd: how strong tones and broadband floor are");
    v.Field("file", file, MayBeEmpty{},
            "recorded: IMU samples as CSV; rotors, psd: lines of f_hz,g2_per_hz (empty: preset)");
    v.Field("level", level, InRange{0, 1000}, "factor on every amplitude");
    v.Field("axis_ratio", axis_ratio, InRange{0, 10},
            "rotors, psd: amplitude forward, left, up relative to preset or PSD");
    v.Field("angular_rate_rms_radps", angular_rate_rms_radps, InRange{0, 10},
            "rotors, psd: rms of the body's angular rate about each axis");
    v.Field("min_hz", min_hz, InRange{0.1, 1000},
            "slower motion belongs to the dynamics and is left out");
    v.Section("rotors", rotors, "source: rotors");
    v.Section("isolator", isolator, "soft mounts of the bar");
  }
};

}  // namespace windhover
