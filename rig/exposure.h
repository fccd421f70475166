#pragma once

#include <cstdint>
#include <string>

#include "common/config/fields.h"

namespace windhover {

enum class Shutter { kGlobal, kRolling };
template <>
inline constexpr EnumNames<Shutter> kEnumNames<Shutter>{{Shutter::kGlobal, "global"},
                                                        {Shutter::kRolling, "rolling"}};

enum class AutoExposureMode { kOff, kIndependent, kShared };
template <>
inline constexpr EnumNames<AutoExposureMode> kEnumNames<AutoExposureMode>{
    {AutoExposureMode::kOff, "off"},
    {AutoExposureMode::kIndependent, "independent"},
    {AutoExposureMode::kShared, "shared"}};

struct AutoExposureConfig {
  AutoExposureMode mode = AutoExposureMode::kOff;
  double target = 0.18;
  double speed = 0.4;
  double min_ms = 0.05;
  double max_ms = 10;
  double max_gain = 8;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("mode", mode, AnyEnum{}, "each camera for itself, or both by the left one");
    v.Field("target", target, InRange{0.01, 0.9}, "mean linear light of an image, 1 is white");
    v.Field("speed", speed, InRange{0.01, 1}, "share of the logarithmic error taken away a frame");
    v.Field("min_ms", min_ms, InRange{0.001, 1000}, "shortest exposure");
    v.Field("max_ms", max_ms, InRange{0.001, 1000}, "longest exposure; beyond, gain");
    v.Field("max_gain", max_gain, InRange{1, 1000}, "largest gain");
  }
};

/// When both cameras collect light.
struct ExposureConfig {
  double duration_ms = 2;
  double max_blur_px = 0.5;
  int max_samples = 16;
  Shutter shutter = Shutter::kGlobal;
  double row_time_us = 44;
  double skew_ms = 0;
  double jitter_ms = 0;
  AutoExposureConfig auto_exposure = {};

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("duration_ms", duration_ms, InRange{0.001, 1000}, "exposure time of both cameras");
    v.Field("max_blur_px", max_blur_px, InRange{0.01, 100},
            "image motion that one sub-exposure may hide");
    v.Field("max_samples", max_samples, InRange{1, 256}, "most sub-exposures of a frame");
    v.Field("shutter", shutter, AnyEnum{}, "all rows at once, or one after the other");
    v.Field("row_time_us", row_time_us, InRange{0, 10000},
            "rolling: how much later than the row above it a row is exposed");
    v.Field("skew_ms", skew_ms, InRange{-1000, 1000}, "how much later the right camera exposes");
    v.Field("jitter_ms", jitter_ms, InRange{0, 1000},
            "standard deviation of each camera's trigger");
    v.Section("auto", auto_exposure, "exposure by the brightness of the image");
  }
};

/// When one camera takes one frame. Times are seconds from the frame's utime.
struct ShutterTimes {
  double middle_s = 0;    ///< Middle of the exposure of the middle row.
  double duration_s = 0;  ///< Of every row.
  double row_time_s = 0;  ///< 0: global shutter.
  double middle_row = 0;  ///< (height - 1) / 2.

  double RowMiddle_s(double row) const { return middle_s + (row - middle_row) * row_time_s; }
};

struct StereoShutterTimes {
  ShutterTimes left, right;
};

/// When both cameras of the aircraft `name` ("uav0") take the frame of `utime_us`. Exposures of
/// the nominal duration, `exposure.duration_ms`, have their middle at utime; others start when
/// those would. The right camera is `skew_ms` later, and both jitter independently, as a function
/// of seed, name, camera and utime alone.
StereoShutterTimes ShutterTimesAt(const ExposureConfig& exposure, double left_duration_s,
                                  double right_duration_s, int height_px, std::uint64_t seed,
                                  const std::string& name, std::int64_t utime_us);

}  // namespace windhover
