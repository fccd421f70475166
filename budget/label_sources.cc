// What the UWB labels add that estimates are held against.

#include <cmath>
#include <utility>

#include "budget/label_error.h"
#include "budget/source_lists.h"
#include "common/ranging/two_way_ranging.h"

namespace windhover {
namespace {

double Range_m(const Sight& at) {
  return at.depth_m * std::hypot(1, (at.x + at.x_right()) / 2, at.y);
}

bool IsInterpolated(const UwbConfig& uwb) {
  return uwb.rate_hz > 0 && uwb.label == UwbLabel::kInterpolated;
}

// What interpolation between two samples, at a place between them that may be any, leaves of the
// variance of each: the mean of (1 - s)² + s².
double VarianceLeft(const UwbConfig& uwb) { return IsInterpolated(uwb) ? 2.0 / 3 : 1; }

void CopySampling(const UwbConfig& from, UwbConfig* to) {
  if (!IsInterpolated(from)) return;
  to->rate_hz = from.rate_hz;
  to->label = from.label;
}

// Labels that are right but for what `set` copies.
void AddRow(const char* name, const char* key, void (*set)(const Scenario& from, Scenario* to),
            Effect (*first_order)(const Scenario&, const Sight&), ErrorSources* sources,
            DistanceLaw law = DistanceLaw::kConstant) {
  sources->push_back({.name = name,
                      .key = key,
                      .law = law,
                      .switch_on =
                          [set](const Scenario& from, Scenario* to) {
                            to->score.reference = ScoreReference::kUwb;
                            set(from, to);
                          },
                      .first_order = first_order});
}

// An antenna beside the rig is as good as a rig beside the antenna, which leaves the target's
// alone.
void AddObserversAntenna(const Scenario& scenario, ErrorSources* sources) {
  if (AntennaInRig_m(scenario).isZero()) return;
  AddRow(
      "antenna of the observer", "rig.mount, uwb.antenna_m",
      [](const Scenario& from, Scenario* to) {
        const Eigen::Vector3d mount_m =
            -(to->rig.calibrated.X_BR().linear() * AntennaInRig_m(from));
        to->rig.calibrated.mount.position_m = {mount_m.x(), mount_m.y(), mount_m.z()};
      },
      [](const Scenario& of, const Sight& at) {
        // Not to first order alone: a lever across the view counts nearby.
        const double range_m = Range_m(at);
        return Effect{range_m - (range_m * DirectionOf(at) - AntennaInRig_m(of)).norm(), 0};
      },
      sources);
}

void AddTargetsAntenna(const Scenario& scenario, ErrorSources* sources) {
  if (AntennaOfTarget_m(scenario).isZero()) return;
  AddRow(
      "antenna of the target", "uwb.antenna_m, aircraft.N.uwb_antenna_m",
      [](const Scenario& from, Scenario* to) {
        const Eigen::Vector3d antenna_m = AntennaOfTarget_m(from);
        to->uwb.antenna_m = {antenna_m.x(), antenna_m.y(), antenna_m.z()};
        for (std::size_t i = 0; i < 3; ++i) to->rig.calibrated.mount.position_m[i] += antenna_m[i];
      },
      [](const Scenario& of, const Sight& at) {
        // Any heading is as likely as any other.
        const Eigen::Vector3d antenna_m = AntennaOfTarget_m(of);
        const double up = DirectionOf(at).dot(UpInRig(of));
        const double level = std::sqrt(1 - up * up);
        return Effect{-up * antenna_m.z(), level * antenna_m.head<2>().norm() / std::sqrt(2)};
      },
      sources);
}

void AddConstants(const UwbConfig& uwb, ErrorSources* sources) {
  if (uwb.bias_m != 0) {
    AddRow(
        "bias of the label", "uwb.bias_m",
        [](const Scenario& from, Scenario* to) { to->uwb.bias_m = from.uwb.bias_m; },
        [](const Scenario& of, const Sight&) {
          return Effect{-of.uwb.bias_m, 0};
        },
        sources);
  }
  if (uwb.power_bias != 0) {
    AddRow(
        "received power of the label", "uwb.power_bias",
        [](const Scenario& from, Scenario* to) { to->uwb.power_bias = from.uwb.power_bias; },
        [](const Scenario& of, const Sight& at) {
          return Effect{-of.uwb.power_bias * PowerBias_m(Range_m(at)), 0};
        },
        sources);
  }
  if (uwb.ranging == Ranging::kIdeal || uwb.clock_sigma_ppm == 0) return;
  AddRow(
      "clocks of the label's radios", "uwb.ranging, uwb.clock_sigma_ppm",
      [](const Scenario& from, Scenario* to) {
        to->uwb.ranging = from.uwb.ranging;
        to->uwb.clock_sigma_ppm = from.uwb.clock_sigma_ppm;
        to->uwb.reply_us = from.uwb.reply_us;
      },
      [](const Scenario& of, const Sight& at) {
        // One-sided half the difference of both clocks over the reply, else their mean over the
        // way.
        const bool is_single = of.uwb.ranging == Ranging::kSingleSided;
        const double over_m = is_single ? kSpeedOfLight_mps * 1e-6 * of.uwb.reply_us : Range_m(at);
        return Effect{0, over_m * 1e-6 * of.uwb.clock_sigma_ppm / std::sqrt(2)};
      },
      sources,
      uwb.ranging == Ranging::kSingleSided ? DistanceLaw::kConstant : DistanceLaw::kLinear);
}

void AddNoise(const UwbConfig& uwb, ErrorSources* sources) {
  if (uwb.sigma_m > 0 || uwb.antenna_delay_sigma_m > 0) {
    AddRow(
        "noise of the label", "uwb.sigma_m, uwb.antenna_delay_sigma_m",
        [](const Scenario& from, Scenario* to) {
          CopySampling(from.uwb, &to->uwb);
          to->uwb.sigma_m = from.uwb.sigma_m;
          to->uwb.antenna_delay_sigma_m = from.uwb.antenna_delay_sigma_m;
        },
        [](const Scenario& of, const Sight&) {
          const double noise_m = std::sqrt(VarianceLeft(of.uwb)) * of.uwb.sigma_m;
          return Effect{0, std::hypot(noise_m, of.uwb.antenna_delay_sigma_m)};
        },
        sources);
  }
}

void AddExcesses(const UwbConfig& uwb, ErrorSources* sources) {
  if (uwb.nlos_fraction > 0 && uwb.nlos_mean_m > 0) {
    AddRow(
        "labels without line of sight", "uwb.nlos_fraction, uwb.nlos_mean_m",
        [](const Scenario& from, Scenario* to) {
          CopySampling(from.uwb, &to->uwb);
          to->uwb.nlos_fraction = from.uwb.nlos_fraction;
          to->uwb.nlos_mean_m = from.uwb.nlos_mean_m;
        },
        [](const Scenario& of, const Sight&) {
          // Exponential while it lasts, for both samples of an interpolation or for neither.
          const double fraction = of.uwb.nlos_fraction, mean_m = of.uwb.nlos_mean_m;
          const double square = 1 + VarianceLeft(of.uwb);
          return Effect{-fraction * mean_m, mean_m * std::sqrt(fraction * (square - fraction))};
        },
        sources);
  }
  if (uwb.outlier_rate > 0 && uwb.outlier_m > 0) {
    AddRow(
        "outliers of the label", "uwb.outlier_rate, uwb.outlier_m",
        [](const Scenario& from, Scenario* to) {
          CopySampling(from.uwb, &to->uwb);
          to->uwb.outlier_rate = from.uwb.outlier_rate;
          to->uwb.outlier_m = from.uwb.outlier_m;
        },
        [](const Scenario& of, const Sight&) {
          const double variance_m2 = of.uwb.outlier_rate * of.uwb.outlier_m * of.uwb.outlier_m / 3;
          return Effect{0, std::sqrt(VarianceLeft(of.uwb) * variance_m2)};
        },
        sources);
  }
}

// A target that moves is elsewhere when a sample is taken.
void AddLatency(const UwbConfig& uwb, ErrorSources* sources) {
  if (uwb.latency_s != 0 || uwb.latency_sigma_s != 0) {
    AddRow(
        "latency of the label", "uwb.latency_s, uwb.latency_sigma_s",
        [](const Scenario& from, Scenario* to) {
          to->uwb.latency_s = from.uwb.latency_s;
          to->uwb.latency_sigma_s = from.uwb.latency_sigma_s;
        },
        [](const Scenario& of, const Sight& at) {
          const double rate_mps = RangeRate_mps(at);
          return Effect{rate_mps * of.uwb.latency_s, std::abs(rate_mps) * of.uwb.latency_sigma_s};
        },
        sources);
  }
  if (uwb.jitter_s > 0) {
    AddRow(
        "jitter of the label's stamps", "uwb.jitter_s",
        [](const Scenario& from, Scenario* to) {
          CopySampling(from.uwb, &to->uwb);
          to->uwb.jitter_s = from.uwb.jitter_s;
        },
        [](const Scenario& of, const Sight& at) {
          const double left = std::sqrt(VarianceLeft(of.uwb));
          return Effect{0, left * std::abs(RangeRate_mps(at)) * of.uwb.jitter_s};
        },
        sources);
  }
}

void AddClock(const UwbConfig& uwb, ErrorSources* sources) {
  if (uwb.drift_ppm != 0) {
    AddRow(
        "drift of the label's clock", "uwb.drift_ppm",
        [](const Scenario& from, Scenario* to) { to->uwb.drift_ppm = from.uwb.drift_ppm; },
        [](const Scenario& of, const Sight& at) {
          // From nothing to all of it, evenly over the flight.
          const double all_m = RangeRate_mps(at) * 1e-6 * of.uwb.drift_ppm * of.duration_s;
          return Effect{all_m / 2, std::abs(all_m) / std::sqrt(12)};
        },
        sources);
  }
  if (uwb.rate_hz > 0 && uwb.label == UwbLabel::kNearest) {
    AddRow(
        "time to the nearest sample", "uwb.rate_hz",
        [](const Scenario& from, Scenario* to) { to->uwb.rate_hz = from.uwb.rate_hz; },
        [](const Scenario& of, const Sight& at) {
          return Effect{0, std::abs(RangeRate_mps(at)) / (of.uwb.rate_hz * std::sqrt(12))};
        },
        sources);
  }
}

}  // namespace

void AddLabelSources(const Scenario& scenario, ErrorSources* sources) {
  if (scenario.score.reference != ScoreReference::kUwb) return;
  AddObserversAntenna(scenario, sources);
  AddTargetsAntenna(scenario, sources);
  AddConstants(scenario.uwb, sources);
  AddNoise(scenario.uwb, sources);
  AddExcesses(scenario.uwb, sources);
  AddLatency(scenario.uwb, sources);
  AddClock(scenario.uwb, sources);
}

}  // namespace windhover
