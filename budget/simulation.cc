// The simulated half of the error budget: the one place that asks RigMotion.

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "budget/error_budget.h"
#include "budget/label_error.h"
#include "common/geometry/rotation.h"
#include "common/random/random_stream.h"
#include "rig/base_vibration.h"
#include "rig/exposure.h"
#include "rig/optics.h"
#include "rig/rig_motion.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr const char* kObserver = "uav0";

/// Running mean and variance.
class Moments {
 public:
  void Add(double x) {
    ++n_;
    const double step = x - mean_;
    mean_ += step / n_;
    squares_ += step * (x - mean_);
  }
  Effect Result() const { return {mean_, n_ > 1 ? std::sqrt(squares_ / (n_ - 1)) : 0}; }
  int count() const { return n_; }

 private:
  int n_ = 0;
  double mean_ = 0, squares_ = 0;
};

Vector3d Direction(const BudgetPlan& plan) {
  return Vector3d(std::tan(RadFromDeg(plan.right_deg)), std::tan(RadFromDeg(plan.down_deg)), 1)
      .normalized();
}

/// Both cameras at one instant, each when it exposes a row.
class Exposures {
 public:
  Exposures(const RigMotion& motion, const RigDrive& drive, const StereoShutterTimes& times)
      : motion_(motion), drive_(drive), times_(times) {}

  /// A target that is at `p_RT_m` when the frame is due, and moves on. `row`: where it is seen.
  std::optional<StereoPixels> Project(const Vector3d& p_RT_m, const Vector3d& v_mps, double row) {
    const double left_s = times_.left.RowMiddle_s(row), right_s = times_.right.RowMiddle_s(row);
    if (rigs_.empty() || left_s != left_s_ || right_s != right_s_) {
      std::vector<double> times_s = {drive_.start_s + left_s};
      if (right_s != left_s) times_s.push_back(drive_.start_s + right_s);
      rigs_ = motion_.AtMany(times_s, drive_);
      left_s_ = left_s, right_s_ = right_s;
    }
    const auto left_px = rigs_[0].left.Project(p_RT_m + left_s * v_mps);
    const auto right_px = rigs_.back().right.Project(p_RT_m + right_s * v_mps);
    if (!left_px || !right_px) return std::nullopt;
    return StereoPixels{*left_px, *right_px};
  }

 private:
  const RigMotion& motion_;
  RigDrive drive_;
  StereoShutterTimes times_;
  double left_s_ = 0, right_s_ = 0;
  std::vector<PosedStereoRig> rigs_;  ///< At both times.
};

/// The random numbers of one flight.
struct Flight {
  Flight(const Scenario& scenario, const StereoRig& at_rest, const GeometricConfig& noise,
         std::uint64_t flight_seed)
      : seed(flight_seed),
        rig(at_rest, scenario.rig.misalignment, scenario.flex, scenario.vibration, seed, kObserver),
        boxes(noise, seed, fmt::format("{}/geometric/target1", kObserver)),
        label(scenario, seed) {}

  std::uint64_t seed;
  RigMotion rig;
  BoxNoise boxes;
  LabelError label;
};

BoxSize SizeOf(const Scenario& scenario, double depth_m) {
  constexpr double kHeightByWidth = 0.378 / 0.887;  // Of an M200.
  const double width_px =
      scenario.rig.calibrated.FocalPx() * scenario.estimator.target_width_m / depth_m;
  return {width_px, kHeightByWidth * width_px};
}

class Simulation {
 public:
  Simulation(const Scenario& scenario, const BudgetPlan& plan)
      : scenario_(scenario),
        plan_(plan),
        calibrated_(scenario.rig.calibrated.ToStereoRig()),
        at_rest_(WithOptics(calibrated_, scenario.optics, 1e-3 * scenario.rig.calibrated.focal_mm)),
        // Of other ways to observe only the pictures know how boxes err.
        boxes_(scenario.observe == Observe::kGeometric ? scenario.geometric
                                                       : InOrder(scenario).geometric),
        moments_(plan.distances_m.size()) {
    for (const double distance_m : plan.distances_m) {
      const auto seen = Posed(calibrated_).left.Project(distance_m * Direction(plan));
      rows_.push_back(seen ? seen->y() : 0);  // Unseen there is no distance either.
    }
  }

  void Fly(std::uint64_t seed) {
    const Flight flight(scenario_, at_rest_, boxes_, seed);
    RandomStream random(seed, "budget/instants");
    const std::array<double, 4> rates_hz = RotorRates_hz(&random);
    for (int i = 0; i < plan_.n_instants; ++i) {
      const double t_s = random.Uniform(0, scenario_.duration_s);
      Exposures exposures(flight.rig, Hovering(t_s, rates_hz, &random), ShuttersAt(seed, t_s));
      for (std::size_t k = 0; k < plan_.distances_m.size(); ++k) {
        const Vector3d p_RT_m = plan_.distances_m[k] * Direction(plan_);
        const auto range_m = EstimatedRange_m(flight, i, p_RT_m, rows_[k], &exposures);
        if (!range_m) continue;
        const double label_m = flight.label.At_m(i, t_s, p_RT_m, plan_.v_mps);
        moments_[k].Add(*range_m - p_RT_m.norm() - label_m);
      }
    }
  }

  SimulatedErrors Result() const {
    SimulatedErrors errors;
    const double n = 1.0 * plan_.n_flights * plan_.n_instants;
    for (const Moments& moments : moments_) {
      errors.effects.push_back(moments.Result());
      errors.no_distance.push_back(1 - moments.count() / n);
    }
    return errors;
  }

 private:
  // Rotors of a level aircraft, each at its own speed about the reference.
  std::array<double, 4> RotorRates_hz(RandomStream* random) const {
    std::array<double, 4> rates_hz;
    for (double& rate_hz : rates_hz) {
      rate_hz = scenario_.vibration.rotors.reference_hz *
                random->Uniform(1 - kRotorSpread, 1 + kRotorSpread);
    }
    return rates_hz;
  }

  static RigDrive Hovering(double t_s, const std::array<double, 4>& rates_hz,
                           RandomStream* random) {
    RigDrive drive;
    drive.start_s = t_s;
    drive.rotor_rate_hz = rates_hz;
    for (double& phase_rev : drive.rotor_phase_rev) phase_rev = random->Uniform();
    return drive;
  }

  // Of a frame with its middle at t_s. The random numbers are those of the time in microseconds.
  StereoShutterTimes ShuttersAt(std::uint64_t seed, double t_s) const {
    const ExposureConfig& exposure = scenario_.exposure;
    const double duration_s = 1e-3 * exposure.duration_ms;
    return ShutterTimesAt(exposure, duration_s, duration_s, calibrated_.height_px, seed, kObserver,
                          std::llround(1e6 * t_s));
  }

  std::optional<double> EstimatedRange_m(const Flight& flight, int instant, const Vector3d& p_RT_m,
                                         double row, Exposures* exposures) const {
    const auto seen = exposures->Project(p_RT_m, plan_.v_mps, row);
    if (!seen) return std::nullopt;
    const BoxSize size = SizeOf(scenario_, p_RT_m.z());
    const auto errors = flight.boxes.At(instant, size, size);
    if (!errors) return std::nullopt;
    const auto point =
        Triangulate(calibrated_, seen->left_px + Eigen::Vector2d(errors->left.x, errors->left.y),
                    seen->right_px + Eigen::Vector2d(errors->right.x, errors->right.y), 0);
    if (!point) return std::nullopt;
    return point->range_m;
  }

  const Scenario& scenario_;
  const BudgetPlan& plan_;
  StereoRig calibrated_, at_rest_;
  GeometricConfig boxes_;
  std::vector<double> rows_;  ///< That see the target, one a distance.
  std::vector<Moments> moments_;
};

}  // namespace

SimulatedErrors Simulate(const Scenario& scenario, const BudgetPlan& plan) {
  Simulation simulation(scenario, plan);
  for (int flight = 0; flight < plan.n_flights; ++flight) {
    RandomStream seeds(scenario.random_seed, fmt::format("budget/flight{}", flight));
    simulation.Fly(seeds());
  }
  return simulation.Result();
}

Sight SightAt(const Scenario& scenario, const BudgetPlan& plan, double distance_m) {
  const Vector3d p_RT_m = distance_m * Direction(plan);
  const double baseline_m = scenario.rig.calibrated.baseline_m;
  return {.focal_px = scenario.rig.calibrated.FocalPx(),
          .baseline_m = baseline_m,
          .depth_m = p_RT_m.z(),
          .x = (p_RT_m.x() + baseline_m / 2) / p_RT_m.z(),
          .y = p_RT_m.y() / p_RT_m.z(),
          .v_mps = plan.v_mps};
}

}  // namespace windhover
