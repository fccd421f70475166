#include "rig/exposure.h"

#include "common/random/random_stream.h"

namespace windhover {
namespace {

double Jitter_s(const ExposureConfig& exposure, std::uint64_t seed, const std::string& name,
                const char* trigger, std::int64_t utime_us) {
  constexpr std::uint64_t kDrawsPerFrame = 4;
  if (exposure.jitter_ms == 0) return 0;
  RandomStream stream(seed, name + trigger);
  stream.Seek(static_cast<std::uint64_t>(utime_us) * kDrawsPerFrame);
  return exposure.jitter_ms * 1e-3 * stream.Normal();
}

}  // namespace

StereoShutterTimes ShutterTimesAt(const ExposureConfig& exposure, double left_duration_s,
                                  double right_duration_s, int height_px, std::uint64_t seed,
                                  const std::string& name, std::int64_t utime_us) {
  const double nominal_s = exposure.duration_ms * 1e-3;
  const double row_time_s = exposure.shutter == Shutter::kRolling ? exposure.row_time_us * 1e-6 : 0;
  const auto times = [&](double trigger_s, double duration_s) {
    return ShutterTimes{.middle_s = trigger_s + (duration_s - nominal_s) / 2,
                        .duration_s = duration_s,
                        .row_time_s = row_time_s,
                        .middle_row = (height_px - 1) / 2.0};
  };
  const double left_s = Jitter_s(exposure, seed, name, "/trigger/left", utime_us);
  const double right_s = Jitter_s(exposure, seed, name, "/trigger/right", utime_us);
  return {times(left_s, left_duration_s),
          times(exposure.skew_ms * 1e-3 + right_s, right_duration_s)};
}

}  // namespace windhover
