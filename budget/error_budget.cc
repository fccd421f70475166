#include "budget/error_budget.h"

#include <cmath>

namespace windhover {
namespace {

std::vector<Effect> FirstOrder(const ErrorSource& source, const Scenario& scenario,
                               const BudgetPlan& plan) {
  std::vector<Effect> effects;
  for (const double distance_m : plan.distances_m) {
    effects.push_back(source.first_order(scenario, SightAt(scenario, plan, distance_m)));
  }
  return effects;
}

void AddRow(const ErrorSource& source, const Scenario& scenario, const BudgetPlan& plan,
            ErrorBudget* budget) {
  BudgetRow row{.name = source.name,
                .key = source.key,
                .law = source.law,
                .first_order = FirstOrder(source, scenario, plan),
                .simulated = {},
                .variance_share = {}};
  Scenario alone = InOrder(scenario);
  source.switch_on(scenario, &alone);
  row.simulated = Simulate(alone, plan).effects;
  budget->rows.push_back(std::move(row));
}

std::vector<Effect> Sum(const std::vector<BudgetRow>& rows, std::size_t n_distances,
                        std::vector<Effect> BudgetRow::*effects) {
  std::vector<Effect> sum(n_distances);
  for (std::size_t i = 0; i < n_distances; ++i) {
    for (const BudgetRow& row : rows) {
      const Effect& effect = (row.*effects)[i];
      sum[i].bias_m += effect.bias_m;
      sum[i].sigma_m = std::hypot(sum[i].sigma_m, effect.sigma_m);
    }
  }
  return sum;
}

}  // namespace

ErrorBudget ComputeErrorBudget(const Scenario& scenario, const BudgetPlan& plan) {
  ErrorBudget budget;
  budget.description = scenario.description;
  budget.distances_m = plan.distances_m;
  for (const ErrorSource& source : ErrorSourcesOf(scenario)) {
    AddRow(source, scenario, plan, &budget);
  }
  const std::size_t n = plan.distances_m.size();
  budget.first_order_sum = Sum(budget.rows, n, &BudgetRow::first_order);
  budget.simulated_sum = Sum(budget.rows, n, &BudgetRow::simulated);
  SimulatedErrors together = Simulate(scenario, plan);
  budget.together = std::move(together.effects);
  budget.no_distance = std::move(together.no_distance);
  for (BudgetRow& row : budget.rows) {
    for (std::size_t i = 0; i < n; ++i) {
      const double all_m = budget.simulated_sum[i].sigma_m;
      const double share = all_m > 0 ? row.simulated[i].sigma_m / all_m : 0;
      row.variance_share.push_back(share * share);
    }
  }
  return budget;
}

ErrorTotals ComputeErrorTotals(const Scenario& scenario, const BudgetPlan& plan) {
  std::vector<BudgetRow> rows;
  for (const ErrorSource& source : ErrorSourcesOf(scenario)) {
    rows.emplace_back().first_order = FirstOrder(source, scenario, plan);
  }
  return {.first_order = Sum(rows, plan.distances_m.size(), &BudgetRow::first_order),
          .simulated = Simulate(scenario, plan).effects};
}

}  // namespace windhover
