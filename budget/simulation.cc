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

GeometricConfig Exact() {
  GeometricConfig exact;
  exact.sigma_px = exact.sigma_relative = 0;
  return exact;
}

/// The random numbers of one flight.
struct Flight {
  Flight(const Scenario& scenario, std::uint64_t flight_seed)
      : seed(flight_seed),
        rig(scenario.rig.calibrated.ToStereoRig(), scenario.rig.misalignment, scenario.flex,
            scenario.vibration, seed, kObserver),
        // Of other ways to observe only the pictures know how boxes err.
        boxes(scenario.observe == Observe::kGeometric ? scenario.geometric : Exact(), seed,
              fmt::format("{}/geometric/target1", kObserver)),
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
        moments_(plan.distances_m.size()) {}

  void Fly(std::uint64_t seed) {
    const Flight flight(scenario_, seed);
    RandomStream random(seed, "budget/instants");
    const std::array<double, 4> rates_hz = RotorRates_hz(&random);
    for (int i = 0; i < plan_.n_instants; ++i) {
      const double t_s = random.Uniform(0, scenario_.duration_s);
      const PosedStereoRig rig = flight.rig.At(t_s, Hovering(t_s, rates_hz, &random));
      for (std::size_t k = 0; k < plan_.distances_m.size(); ++k) {
        const Vector3d p_RT_m = plan_.distances_m[k] * Direction(plan_);
        const auto range_m = EstimatedRange_m(flight, rig, i, p_RT_m);
        if (!range_m) continue;
        moments_[k].Add(*range_m - p_RT_m.norm() - flight.label.At_m(i, p_RT_m, plan_.v_mps));
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

  std::optional<double> EstimatedRange_m(const Flight& flight, const PosedStereoRig& rig,
                                         int instant, const Vector3d& p_RT_m) const {
    const auto seen = Project(rig, p_RT_m);
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
  StereoRig calibrated_;
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
