#pragma once

#include <cstdint>
#include <optional>

#include "common/time/sim_time.h"

namespace windhover {

/// When the IMUs of a run sample: the world stops there too, so that whoever moves it on by other
/// steps gets other roundings.
class ImuClock {
 public:
  struct Sample {
    std::int64_t number;
    Utime utime;
  };

  /// `rate_hz`: 0 for no IMU.
  explicit ImuClock(double rate_hz) : rate_hz_(rate_hz) {}

  /// The next sample, if it is taken by `end`.
  std::optional<Sample> Next(Utime end) {
    if (rate_hz_ <= 0) return std::nullopt;
    const Sample sample{number_, UtimeFromSeconds(static_cast<double>(number_) / rate_hz_)};
    if (sample.utime > end) return std::nullopt;
    ++number_;
    return sample;
  }

 private:
  double rate_hz_;
  std::int64_t number_ = 0;
};

}  // namespace windhover
