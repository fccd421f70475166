#include "budget/error_budget.h"

#include <algorithm>
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

// Moves distances, always alike. What moves none may still be half of another row's cause.
bool IsConstant(const BudgetRow& row) {
  return std::all_of(row.first_order.begin(), row.first_order.end(), [](const Effect& effect) {
    return effect.bias_m != 0 && effect.sigma_m == 0;
  });
}

std::vector<BudgetRow> RowsOf(const std::vector<ErrorSource>& sources, const Scenario& scenario,
                              const BudgetPlan& plan) {
  const Scenario order = InOrder(scenario);
  std::vector<BudgetRow> rows;
  Scenario constants = order;
  bool has_constants = false;
  for (const ErrorSource& source : sources) {
    BudgetRow& row = rows.emplace_back();
    row.name = source.name;
    row.key = source.key;
    row.law = source.law;
    row.first_order = FirstOrder(source, scenario, plan);
    Scenario alone = order;
    source.switch_on(scenario, &alone);
    row.simulated = Simulate(alone, plan).effects;
    if (!IsConstant(row)) continue;
    source.switch_on(scenario, &constants);
    has_constants = true;
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    BudgetRow& row = rows[i];
    row.beside_constants_m.resize(plan.distances_m.size());
    if (IsConstant(row)) continue;
    Scenario beside = constants;
    sources[i].switch_on(scenario, &beside);
    const std::vector<Effect> effects =
        has_constants ? Simulate(beside, plan).effects : row.simulated;
    for (std::size_t k = 0; k < effects.size(); ++k) row.beside_constants_m[k] = effects[k].sigma_m;
  }
  return rows;
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

// Of each row in the sum of all variances, and that sum.
void AddShares(ErrorBudget* budget) {
  const std::size_t n = budget->distances_m.size();
  budget->beside_constants_sum_m.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    double& all_m = budget->beside_constants_sum_m[i];
    for (const BudgetRow& row : budget->rows) all_m = std::hypot(all_m, row.beside_constants_m[i]);
    for (BudgetRow& row : budget->rows) {
      const double share = all_m > 0 ? row.beside_constants_m[i] / all_m : 0;
      row.variance_share.push_back(share * share);
    }
  }
}

}  // namespace

ErrorBudget ComputeErrorBudget(const Scenario& scenario, const BudgetPlan& plan) {
  ErrorBudget budget;
  budget.description = scenario.description;
  budget.distances_m = plan.distances_m;
  budget.rows = RowsOf(ErrorSourcesOf(scenario), scenario, plan);
  const std::size_t n = plan.distances_m.size();
  budget.first_order_sum = Sum(budget.rows, n, &BudgetRow::first_order);
  budget.simulated_sum = Sum(budget.rows, n, &BudgetRow::simulated);
  SimulatedErrors together = Simulate(scenario, plan);
  budget.together = std::move(together.effects);
  budget.no_distance = std::move(together.no_distance);
  AddShares(&budget);
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
