#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "budget/error_budget.h"

namespace windhover {

/// A budget as JSON: {"description", "bearing_deg", "distances_m", "sources": [{"name", "key",
/// "law", "first_order": [{"bias_m", "sigma_m", "bias_percent", "sigma_percent"}, …],
/// "small": [true, …], "simulated": […], "beside_constants_sigma_m": […], "variance_share": […]}],
/// "first_order_sum", "simulated_sum", "beside_constants_sum_sigma_m", "together", "no_distance"};
/// lists go with distances_m.
nlohmann::ordered_json BudgetJson(const ErrorBudget& budget, const BudgetPlan& plan);

/// The same as a table for a terminal.
std::string BudgetText(const ErrorBudget& budget);

/// Root-mean-square errors of everything together and of the largest sources over distance, as
/// the content of an .svg file: lines to first order, points simulated.
std::string BudgetSvg(const ErrorBudget& budget);

/// Totals while one key of the scenario changes.
struct BudgetSweep {
  std::string key;
  std::vector<double> values, distances_m;
  std::vector<ErrorTotals> totals;  ///< One a value.
};

/// {"key", "distances_m", "points": [{"value", "first_order": […], "simulated": […]}]}
nlohmann::ordered_json SweepJson(const BudgetSweep& sweep);

/// As a table for a terminal.
std::string SweepText(const BudgetSweep& sweep);

/// Relative root-mean-square errors over the key, a line (first order) and points (simulated) for
/// each distance, as the content of an .svg file.
std::string SweepSvg(const BudgetSweep& sweep);

}  // namespace windhover
