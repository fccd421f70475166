#pragma once

#include <functional>
#include <string>
#include <vector>

#include "budget/first_order.h"
#include "scenarios/scenario.h"

namespace windhover {

/// Where and how often an error budget looks.
struct BudgetPlan {
  std::vector<double> distances_m = {5, 10, 20, 30, 40};
  double right_deg = 4, down_deg = 2;  ///< Bearing of the target from the rig's axis.
  Eigen::Vector3d v_mps = {1, 0, 1};   ///< Of the target in the rig's axes (right, down, forward).
  int n_flights = 1000;                ///< Each with random numbers of its own.
  int n_instants = 20;                 ///< Of each flight, at random times.
};

/// An error of distance: estimate minus reference.
struct Effect {
  double bias_m = 0, sigma_m = 0;
  /// Of one to first order: by which share of it the next order differs, x of a constant error of
  /// x of the disparity, 4 s² of noise of s of it. Labels have none: their errors add up.
  double left_out = 0;
};

/// Below this an effect is small: simulation agrees with first order to as much.
inline constexpr double kSmall = 0.03;

/// One thing that is wrong with a scenario's rig, its detector or its labels.
struct ErrorSource {
  std::string name;
  std::string key;  ///< Scenario key that switches it on.
  DistanceLaw law;
  /// Takes it, and nothing else, from the scenario to one in which all is in order.
  std::function<void(const Scenario& from, Scenario* to)> switch_on;
  /// To first order.
  std::function<Effect(const Scenario&, const Sight&)> first_order;
};

/// Those that `scenario` switches on.
std::vector<ErrorSource> ErrorSourcesOf(const Scenario& scenario);

/// `scenario` with all of them switched off.
Scenario InOrder(const Scenario& scenario);

/// What the calibrated rig makes of a target that the true rig of `scenario` sees, by exact
/// projection and triangulation of the target's centre, over many flights and instants.
struct SimulatedErrors {
  std::vector<Effect> effects;      ///< One a distance.
  std::vector<double> no_distance;  ///< Share of sights without parallax, left out above.
};
SimulatedErrors Simulate(const Scenario& scenario, const BudgetPlan& plan);

struct BudgetRow {
  std::string name, key;
  DistanceLaw law;
  std::vector<Effect> first_order, simulated;  ///< One a distance.
  /// Standard deviation, simulated with everything constant switched on too, which moves the
  /// distance at which noise acts; 0 of what is constant itself.
  std::vector<double> beside_constants_m;
  std::vector<double> variance_share;  ///< Of the sum of all rows' variances beside constants.
};

struct ErrorBudget {
  std::string description;
  std::vector<double> distances_m;
  std::vector<BudgetRow> rows;
  std::vector<Effect> first_order_sum;  ///< Biases summed, deviations by root of sum of squares.
  std::vector<Effect> simulated_sum;    ///< The same of the simulated rows.
  std::vector<double> beside_constants_sum_m;  ///< Root of the sum of squares.
  std::vector<Effect> together;                ///< Simulated with everything on.
  std::vector<double> no_distance;             ///< Then.
};

/// The first-order and the simulated effect of everything that `scenario` switches on: one at a
/// time, and together, with the same random numbers.
/// @throws ConfigError if a vibration file cannot be used.
ErrorBudget ComputeErrorBudget(const Scenario& scenario, const BudgetPlan& plan);

/// Everything that `scenario` switches on, together, at each distance.
struct ErrorTotals {
  std::vector<Effect> first_order;  ///< Biases summed, deviations by root of sum of squares.
  std::vector<Effect> simulated;
};
ErrorTotals ComputeErrorTotals(const Scenario& scenario, const BudgetPlan& plan);

/// The target at `distance_m` (range), as the first-order table wants it.
Sight SightAt(const Scenario& scenario, const BudgetPlan& plan, double distance_m);

}  // namespace windhover
