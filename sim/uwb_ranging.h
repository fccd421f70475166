#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/random/random_stream.h"
#include "common/time/sim_time.h"
#include "lcmtypes/uwb_t.hpp"
#include "scenarios/scenario.h"
#include "sim/state_history.h"

namespace windhover {

/// Line of sight that comes and goes: a Markov process of two states in continuous time.
class Obstruction {
 public:
  /// Obstructed for `mean_burst_s` on average and `fraction` of the time; from time 0 on.
  Obstruction(double fraction, double mean_burst_s, const RandomStream& stream);

  bool At(double t_s);

 private:
  double mean_clear_s_, mean_burst_s_;
  bool starts_obstructed_ = false;
  RandomStream stream_;
  std::vector<double> changes_s_;  // Rising; drawn as far as somebody has asked.
};

/// The ranges that aircraft measure to each other, as the radios report them at the time of an
/// image:
///
///     r = |p_t + R_t l_t − p_o − R_o l_o| + bias_m + antenna delay + error by power
///         + clock error of the exchange + N(0, sigma_m²) + NLOS excess + outlier
///
/// Sample k is taken at k / rate_hz and stamped (1 + drift) t + latency + jitter. The range of an
/// image is that of the sample stamped nearest to it, or interpolated between its neighbours.
/// Source: A. Shalaby et al., "Calibration and uncertainty characterization for ultra-wideband
/// two-way-ranging measurements", arXiv 2210.05888 (parts and their size).
///
/// Everything random is a function of the scenario's seed, the aircraft and the sample number.
class UwbRanging {
 public:
  explicit UwbRanging(const Scenario& scenario);

  /// Remembers where all aircraft are now, in the scenario's order. A moment between two calls is
  /// interpolated; one after the last, which a sample stamped too early asks for, extrapolated.
  /// @pre utime does not fall from call to call.
  void Observe(Utime utime, const std::vector<Kinematics>& states);

  /// What the aircraft at `position` reports at the time of the last Observe(), in image number
  /// `image` (from -1).
  uwb_t Report(int position, std::int64_t image);

  /// By how much this flight's stamps of the aircraft at `position` are late; may be negative.
  double Latency_s(int position) const { return radios_[position].latency_s; }

 private:
  struct Radio {
    int id;
    Eigen::Vector3d antenna_B_m;
    double latency_s, delay_m, clock_ppm;
    RandomStream jitter;
    StateHistory history;
  };
  /// Of the ranges that one radio measures to another.
  struct PairStreams {
    RandomStream noise, nlos, outlier;
  };
  struct Sample {
    std::int64_t number;
    double taken_s, stamp_s;
  };

  struct Weighted {
    Sample sample;
    double weight;
  };

  Sample SampleAt(int position, std::int64_t number) const;
  std::vector<Weighted> SamplesOf(int position, std::int64_t image) const;
  double Measured_m(int own, int target, const Sample& sample);
  double Exchanged_m(const Radio& own, const Radio& target, double distance_m) const;
  double Excess_m(int own, int target, const Sample& sample);
  const PairStreams& StreamsOf(int own, int target) const;
  Obstruction& ObstructionOf(int a, int b);

  std::uint64_t seed_;
  UwbConfig config_;
  std::vector<Radio> radios_;
  std::vector<PairStreams> streams_;       // [own · radios + target]
  std::vector<Obstruction> obstructions_;  // [larger position · (larger − 1) / 2 + smaller]
  double now_s_ = 0;
};

}  // namespace windhover
