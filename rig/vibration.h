#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

enum class VibrationSource { kNone, kPsd, kRecorded };
template <>
inline constexpr EnumNames<VibrationSource> kEnumNames<VibrationSource>{
    {VibrationSource::kNone, "none"},
    {VibrationSource::kPsd, "psd"},
    {VibrationSource::kRecorded, "recorded"}};

/// Vibration at the root of the bar.
struct VibrationConfig {
  VibrationSource source = VibrationSource::kNone;
  InputFile file;  ///< IMU recording (CSV) when source is recorded; PSD (CSV) is optional for psd.
  double level = 1;
  std::array<double, 3> axis_ratio = {0.3, 0.3, 1.0};
  double angular_rate_rms_radps = 0.05;
  double min_hz = 10;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("source", source, AnyEnum{}, "where the vibration comes from");
    v.Field("file", file, MayBeEmpty{},
            "recorded: IMU samples as CSV; psd: lines of f_hz,g2_per_hz (empty: built-in floor)");
    v.Field("level", level, InRange{0, 1000}, "factor on every amplitude");
    v.Field("axis_ratio", axis_ratio, InRange{0, 10},
            "psd: amplitude forward, left, up relative to the PSD");
    v.Field("angular_rate_rms_radps", angular_rate_rms_radps, InRange{0, 10},
            "psd: rms of the body's angular rate about each axis");
    v.Field("min_hz", min_hz, InRange{0.1, 1000},
            "slower motion belongs to the dynamics and is left out");
  }
};

}  // namespace windhover
