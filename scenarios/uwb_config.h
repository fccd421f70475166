#pragma once

#include <array>

#include "common/config/fields.h"

namespace windhover {

/// How two radios measure their distance (common/ranging/two_way_ranging.h).
enum class Ranging { kIdeal, kSingleSided, kDoubleSided };
template <>
inline constexpr EnumNames<Ranging> kEnumNames<Ranging>{{Ranging::kIdeal, "ideal"},
                                                        {Ranging::kSingleSided, "single_sided"},
                                                        {Ranging::kDoubleSided, "double_sided"}};

/// How samples become the range of an image.
enum class UwbLabel { kNearest, kInterpolated };
template <>
inline constexpr EnumNames<UwbLabel> kEnumNames<UwbLabel>{
    {UwbLabel::kNearest, "nearest"}, {UwbLabel::kInterpolated, "interpolated"}};

/// Ranging radios: what a range is off by, and when it was measured (sim/uwb_ranging.h).
struct UwbConfig {
  double sigma_m = 0.05;
  double bias_m = 0;
  std::array<double, 3> antenna_m = {0, 0, 0};
  double antenna_delay_sigma_m = 0;
  double power_bias = 0;
  Ranging ranging = Ranging::kIdeal;
  double clock_sigma_ppm = 10;
  double reply_us = 200;
  double nlos_fraction = 0;
  double nlos_burst_s = 1;
  double nlos_mean_m = 0.3;
  double outlier_rate = 0;
  double outlier_m = 5;
  double rate_hz = 0;
  UwbLabel label = UwbLabel::kNearest;
  double latency_s = 0;
  double latency_sigma_s = 0;
  double jitter_s = 0;
  double drift_ppm = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("sigma_m", sigma_m, InRange{0, 100}, "standard deviation of a range");
    v.Field("bias_m", bias_m, InRange{-100, 100}, "error common to all ranges");
    v.Field("antenna_m", antenna_m, InRange{-5, 5},
            "where every aircraft has its antenna, in the body frame");
    v.Field("antenna_delay_sigma_m", antenna_delay_sigma_m, InRange{0, 10},
            "deviation of a pair's constant error from flight to flight");
    v.Field("power_bias", power_bias, InRange{-10, 10},
            "share of a DW1000's error by received power: 1 is as sold, 0 corrected");
    v.Field("ranging", ranging, AnyEnum{}, "exchange of messages behind a range");
    v.Field("clock_sigma_ppm", clock_sigma_ppm, InRange{0, 100},
            "deviation of a radio's clock rate from flight to flight");
    v.Field("reply_us", reply_us, InRange{1, 1e5}, "time a radio takes to reply");
    v.Field("nlos_fraction", nlos_fraction, InRange{0, 0.9}, "share of time without line of sight");
    v.Field("nlos_burst_s", nlos_burst_s, InRange{0.001, 1e4}, "mean time without line of sight");
    v.Field("nlos_mean_m", nlos_mean_m, InRange{0, 100},
            "mean excess of a range without line of sight (exponential)");
    v.Field("outlier_rate", outlier_rate, InRange{0, 1}, "share of ranges that are outliers");
    v.Field("outlier_m", outlier_m, InRange{0, 1000}, "largest error of an outlier (uniform)");
    v.Field("rate_hz", rate_hz, InRange{0, 1000}, "samples per second; 0: one for each image");
    v.Field("label", label, AnyEnum{}, "how samples become the range of an image");
    v.Field("latency_s", latency_s, InRange{0, 1}, "a sample is stamped so much after it is taken");
    v.Field("latency_sigma_s", latency_sigma_s, InRange{0, 0.5},
            "deviation of the latency from flight to flight");
    v.Field("jitter_s", jitter_s, InRange{0, 0.1}, "deviation of a single stamp");
    v.Field("drift_ppm", drift_ppm, InRange{-100, 100}, "rate error of the stamping clock");
  }
};

}  // namespace windhover
