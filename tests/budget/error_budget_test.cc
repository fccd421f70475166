// The two halves of the error budget against each other: the first-order table, and exact
// projection through the true rig over many flights.

#include "budget/error_budget.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace windhover {
namespace {

const std::string kPresets = std::string(WINDHOVER_SOURCE_DIR) + "/scenarios/presets/";

Scenario Preset(const std::string& name, std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.end(), {"description=x", "aircraft=[{id: 0}]", "observe=geometric"});
  return LoadScenario(kPresets + name + ".yaml", overrides);
}

// Distances at which noise stays below 5 % of the disparity: where first order is meant to hold.
BudgetPlan SmallErrors() {
  BudgetPlan plan;
  plan.distances_m = {5, 10, 20, 30};
  plan.n_flights = 1500;
  plan.n_instants = 8;
  return plan;
}

// 3 % for what is left out, and four standard errors of what is drawn once a flight.
void ExpectHalvesAgree(const ErrorBudget& budget, const BudgetPlan& plan) {
  const double draws = std::sqrt(plan.n_flights);
  for (const BudgetRow& row : budget.rows) {
    for (std::size_t i = 0; i < plan.distances_m.size(); ++i) {
      SCOPED_TRACE(row.name + " at " + std::to_string(plan.distances_m[i]));
      const Effect &closed = row.first_order[i], &simulated = row.simulated[i];
      const double sigma_m = closed.sigma_m;
      EXPECT_NEAR(simulated.sigma_m, sigma_m, (0.03 + 4 / (std::sqrt(2) * draws)) * sigma_m + 1e-4);
      EXPECT_NEAR(simulated.bias_m, closed.bias_m,
                  0.03 * std::abs(closed.bias_m) + 4 * sigma_m / draws + 2e-4);
    }
  }
}

// A calibrated rig: vibration, flex and boxes. Independent causes: their variances add up.
TEST(ErrorBudget, HalvesAgreeAndVariancesAddUpForACalibratedRig) {
  const BudgetPlan plan = SmallErrors();
  const ErrorBudget budget = ComputeErrorBudget(Preset("calibrated"), plan);
  EXPECT_EQ(budget.rows.size(), 6U);
  ExpectHalvesAgree(budget, plan);
  for (std::size_t i = 0; i < plan.distances_m.size(); ++i) {
    const double sum_m2 = std::pow(budget.simulated_sum[i].sigma_m, 2);
    // 12,000 draws know a variance to 1.3 %.
    EXPECT_NEAR(std::pow(budget.together[i].sigma_m, 2) / sum_m2, 1, 0.1);
    double shares = 0;
    for (const BudgetRow& row : budget.rows) shares += row.variance_share[i];
    EXPECT_NEAR(shares, 1, 1e-9);
    EXPECT_EQ(budget.no_distance[i], 0);
  }
}

// Everything else that a scenario can switch on, in amounts that stay small.
TEST(ErrorBudget, HalvesAgreeForEveryOtherSource) {
  const BudgetPlan plan = SmallErrors();
  const Scenario scenario = Preset(
      "calibrated",
      {"rig.misalignment={offset_px: 0.2, left: {yaw_deg: 0.004, pitch_deg: 0.02, roll_deg: 0.02, "
       "cx_px: 0.3}, right: {yaw_deg: 0.004, pitch_deg: 0.02, roll_deg: 0.02, cx_px: -0.2}, "
       "random: {offset_sigma_px: 0.3, offset_spread_px: 0.3, yaw_sigma_deg: 0.005, "
       "pitch_sigma_deg: 0.01, roll_sigma_deg: 0.02}}",
       "flex={enabled: true, section: al_plate_40x4_weak, thermal_gradient_K: 0.1, "
       "thermal_mean_K: 100, drift: {yaw_sigma_deg: 0.005, roll_sigma_deg: 0.02, "
       "time_constant_s: 5}, landing: {time_s: 6, yaw_deg: 0.01}}",
       "vibration.level=0.1", "vibration.source=rotors",
       "geometric={sigma_px: 0, sigma_relative: 0, gross_rate: 0.2, gross_sigma: 0.01}",
       "uwb={sigma_m: 0.1, bias_m: 0.05, antenna_delay_sigma_m: 0.05, latency_s: 0.02, "
       "latency_sigma_s: 0.1}",
       "score.reference=uwb"});
  const ErrorBudget budget = ComputeErrorBudget(scenario, plan);
  EXPECT_EQ(budget.rows.size(), 24U);
  ExpectHalvesAgree(budget, plan);
}

// The paper's 70 px: first order says -84 m at 40 m, the rig measures 12 m.
TEST(ErrorBudget, SaysWhatFirstOrderCannot) {
  BudgetPlan plan;
  plan.distances_m = {40};
  plan.n_flights = 2;
  const ErrorBudget budget = ComputeErrorBudget(Preset("uavde_12mm"), plan);
  EXPECT_EQ(budget.rows.front().key, "rig.misalignment.offset_px");
  EXPECT_LT(budget.rows.front().first_order[0].bias_m, -80);
  EXPECT_NEAR(budget.rows.front().simulated[0].bias_m, 40 / (1 + 40 * 70 / 1305.3) - 40, 0.3);
  const ErrorBudget behind =
      ComputeErrorBudget(Preset("uavde_12mm", {"rig.misalignment.offset_px=-70"}), plan);
  EXPECT_EQ(behind.no_distance[0], 1);
}

}  // namespace
}  // namespace windhover
