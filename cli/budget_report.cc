#include "cli/budget_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "eval/svg_chart.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;
using Effects = std::vector<Effect>;

Json EffectsJson(const Effects& effects, const std::vector<double>& distances_m) {
  Json json = Json::array();
  for (std::size_t i = 0; i < effects.size(); ++i) {
    json.push_back({{"bias_m", effects[i].bias_m},
                    {"sigma_m", effects[i].sigma_m},
                    {"bias_percent", 100 * effects[i].bias_m / distances_m[i]},
                    {"sigma_percent", 100 * effects[i].sigma_m / distances_m[i]}});
  }
  return json;
}

Json AreSmall(const Effects& first_order) {
  Json json = Json::array();
  for (const Effect& effect : first_order) json.push_back(effect.left_out < kSmall);
  return json;
}

std::string Number(double value) {
  const double size = std::abs(value);
  if (size < 5e-4) return "0";
  return size < 10 ? fmt::format("{:.3f}", value) : fmt::format("{:.1f}", value);
}

// "-0.123 ± 0.045"; only the part that is there.
std::string Cell(const Effect& effect) {
  const std::string bias = Number(effect.bias_m), sigma = Number(effect.sigma_m);
  if (sigma == "0") return bias;
  return bias == "0" ? "±" + sigma : bias + " ±" + sigma;
}

std::string Line(const std::string& name, const std::string& law, const char* how,
                 const std::vector<std::string>& cells) {
  std::string text = fmt::format("{:<48} {:<6}{:<14}", name, law, how);
  for (const std::string& cell : cells) text += fmt::format("{:>16}", cell);
  return text + "\n";
}

std::vector<std::string> Cells(const Effects& effects) {
  std::vector<std::string> cells;
  for (const Effect& effect : effects) cells.push_back(Cell(effect));
  return cells;
}

// In parentheses where first order leaves out too much.
std::vector<std::string> FirstOrderCells(const Effects& effects) {
  std::vector<std::string> cells;
  for (const Effect& effect : effects) {
    const std::string cell = Cell(effect);
    cells.push_back(effect.left_out < kSmall ? cell : "(" + cell + ")");
  }
  return cells;
}

std::vector<std::string> Heads(const std::vector<double>& distances_m) {
  std::vector<std::string> heads;
  for (const double distance_m : distances_m) heads.push_back(fmt::format("{} m", distance_m));
  return heads;
}

std::vector<std::string> Percent(const std::vector<double>& shares) {
  std::vector<std::string> cells;
  for (const double share : shares) cells.push_back(fmt::format("{:.1f} %", 100 * share));
  return cells;
}

std::vector<std::string> Deviations(const std::vector<double>& sigmas_m) {
  std::vector<std::string> cells;
  for (const double sigma_m : sigmas_m) cells.push_back("±" + Number(sigma_m));
  return cells;
}

double Rms_m(const Effect& effect) { return std::hypot(effect.bias_m, effect.sigma_m); }

ChartSeries Series(const std::string& name, int look, ChartSeries::Style style,
                   const std::vector<double>& distances_m, const Effects& effects) {
  ChartSeries series{.name = name, .style = style, .look = look, .points = {}};
  for (std::size_t i = 0; i < effects.size(); ++i) {
    series.points.push_back({distances_m[i], Rms_m(effects[i])});
  }
  return series;
}

}  // namespace

Json BudgetJson(const ErrorBudget& budget, const BudgetPlan& plan) {
  Json sources = Json::array();
  for (const BudgetRow& row : budget.rows) {
    sources.push_back({{"name", row.name},
                       {"key", row.key},
                       {"law", NameOf(row.law)},
                       {"first_order", EffectsJson(row.first_order, budget.distances_m)},
                       {"small", AreSmall(row.first_order)},
                       {"simulated", EffectsJson(row.simulated, budget.distances_m)},
                       {"beside_constants_sigma_m", row.beside_constants_m},
                       {"variance_share", row.variance_share}});
  }
  return {{"description", budget.description},
          {"bearing_deg", {plan.right_deg, plan.down_deg}},
          {"velocity_mps", {plan.v_mps.x(), plan.v_mps.y(), plan.v_mps.z()}},
          {"flights", plan.n_flights},
          {"instants", plan.n_instants},
          {"distances_m", budget.distances_m},
          {"sources", std::move(sources)},
          {"first_order_sum", EffectsJson(budget.first_order_sum, budget.distances_m)},
          {"simulated_sum", EffectsJson(budget.simulated_sum, budget.distances_m)},
          {"beside_constants_sum_sigma_m", budget.beside_constants_sum_m},
          {"together", EffectsJson(budget.together, budget.distances_m)},
          {"no_distance", budget.no_distance}};
}

std::string BudgetText(const ErrorBudget& budget) {
  const std::vector<std::string> heads = Heads(budget.distances_m);
  std::string text = fmt::format(
      "{}\nError of the distance in metres: mean ± standard deviation. Law: how it grows with "
      "distance. In parentheses: first order leaves out more than {} %. Variance: share of it "
      "where the constant errors put the distance.\n\n{}",
      budget.description, 100 * kSmall, Line("", "law", "", heads));
  for (const BudgetRow& row : budget.rows) {
    text += Line(row.name, NameOf(row.law), "first order", FirstOrderCells(row.first_order));
    text += Line("  " + row.key, "", "simulated", Cells(row.simulated));
    const bool has_variance = std::any_of(row.variance_share.begin(), row.variance_share.end(),
                                          [](double share) { return share >= 5e-4; });
    if (has_variance) text += Line("", "", "variance", Percent(row.variance_share));
  }
  text += "\n" + Line("sum", "", "first order", Cells(budget.first_order_sum));
  text += Line("", "", "simulated", Cells(budget.simulated_sum));
  text += Line("", "", "where they act", Deviations(budget.beside_constants_sum_m));
  text += Line("all together", "", "simulated", Cells(budget.together));
  std::vector<std::string> relative;
  for (std::size_t i = 0; i < budget.together.size(); ++i) {
    const double percent = 100 / budget.distances_m[i];
    relative.push_back(fmt::format("{:.1f} ±{:.1f} %", percent * budget.together[i].bias_m,
                                   percent * budget.together[i].sigma_m));
  }
  text += Line("", "", "relative", relative);
  const double worst = *std::max_element(budget.no_distance.begin(), budget.no_distance.end());
  if (worst > 0) text += Line("sights without a distance", "", "", Percent(budget.no_distance));
  return text;
}

std::string BudgetSvg(const ErrorBudget& budget) {
  constexpr std::size_t kLargest = 5;
  std::vector<const BudgetRow*> rows;
  for (const BudgetRow& row : budget.rows) rows.push_back(&row);
  const auto size_m = [](const BudgetRow* row) { return Rms_m(row->simulated.back()); };
  std::stable_sort(rows.begin(), rows.end(),
                   [&](auto* a, auto* b) { return size_m(a) > size_m(b); });
  rows.resize(std::min(rows.size(), kLargest));
  Chart chart;
  chart.title = "What each disturbance costs (line: first order, points: simulated)";
  chart.x_label = "distance, m";
  chart.y_label = "root mean square error, m";
  using Style = ChartSeries::Style;
  int look = 0;
  for (const BudgetRow* row : rows) {
    chart.series.push_back(
        Series(row->name, look, Style::kLine, budget.distances_m, row->first_order));
    chart.series.push_back(Series("", look++, Style::kPoints, budget.distances_m, row->simulated));
  }
  chart.series.push_back(
      Series("all together, simulated", -1, Style::kLine, budget.distances_m, budget.together));
  // First-order lines may leave the range of what really happens.
  double largest_m = 0;
  for (const Effect& effect : budget.together) largest_m = std::max(largest_m, Rms_m(effect));
  for (const BudgetRow* row : rows) largest_m = std::max(largest_m, size_m(row));
  chart.y_max = 1.3 * largest_m;
  return ChartFileSvg(chart);
}

Json SweepJson(const BudgetSweep& sweep) {
  Json points = Json::array();
  for (std::size_t i = 0; i < sweep.values.size(); ++i) {
    points.push_back({{"value", sweep.values[i]},
                      {"first_order", EffectsJson(sweep.totals[i].first_order, sweep.distances_m)},
                      {"simulated", EffectsJson(sweep.totals[i].simulated, sweep.distances_m)}});
  }
  return {{"key", sweep.key}, {"distances_m", sweep.distances_m}, {"points", std::move(points)}};
}

std::string SweepText(const BudgetSweep& sweep) {
  std::string text = Line(sweep.key, "", "", Heads(sweep.distances_m));
  for (std::size_t i = 0; i < sweep.values.size(); ++i) {
    const ErrorTotals& totals = sweep.totals[i];
    text += Line(fmt::format("{}", sweep.values[i]), "", "first order", Cells(totals.first_order));
    text += Line("", "", "simulated", Cells(totals.simulated));
  }
  return text;
}

std::string SweepSvg(const BudgetSweep& sweep) {
  using Style = ChartSeries::Style;
  Chart chart;
  chart.title = fmt::format("All disturbances together over {}", sweep.key);
  chart.x_label = sweep.key;
  chart.y_label = "rms error, % of the distance";
  for (std::size_t d = 0; d < sweep.distances_m.size(); ++d) {
    const int look = static_cast<int>(d);
    const std::string name = fmt::format("{} m", sweep.distances_m[d]);
    ChartSeries line{.name = name, .style = Style::kLine, .look = look, .points = {}};
    ChartSeries dots{.name = "", .style = Style::kPoints, .look = look, .points = {}};
    for (std::size_t i = 0; i < sweep.values.size(); ++i) {
      const double percent = 100 / sweep.distances_m[d];
      line.points.push_back({sweep.values[i], percent * Rms_m(sweep.totals[i].first_order[d])});
      dots.points.push_back({sweep.values[i], percent * Rms_m(sweep.totals[i].simulated[d])});
    }
    chart.series.push_back(std::move(line));
    chart.series.push_back(std::move(dots));
  }
  return ChartFileSvg(chart);
}

}  // namespace windhover
