#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "sweep/sweep_figures.h"

namespace windhover {
namespace {

using Eigen::Index;

std::vector<double> ValuesOf(const ResponseGroup& group, std::size_t factor) {
  const auto column = group.x.col(static_cast<Index>(factor));
  return {column.begin(), column.end()};
}

/// The value that most points have, coded: the base's where one factor is changed at a time. The
/// middle one of several.
double UsualOf(const ResponseGroup& group, std::size_t factor) {
  std::map<double, int> counts;
  for (const double value : ValuesOf(group, factor)) ++counts[value];
  int most = 0;
  for (const auto& [value, n] : counts) most = std::max(most, n);
  std::erase_if(counts, [&](const auto& one) { return one.second < most; });
  return std::next(counts.begin(), static_cast<std::ptrdiff_t>(counts.size() / 2))->first;
}

/// Smallest, usual and largest value of a factor, coded.
std::vector<double> ThreeOf(const ResponseGroup& group, std::size_t factor) {
  const std::vector<double> values = ValuesOf(group, factor);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const std::set<double> three = {*low, UsualOf(group, factor), *high};
  return {three.begin(), three.end()};
}

/// Rows of the points that differ from the usual ones in the map's axes alone.
std::vector<Index> RowsOfTheMap(const SweepAnalysis& analysis, const ResponseGroup& group) {
  std::vector<Index> rows(static_cast<std::size_t>(group.x.rows()));
  std::iota(rows.begin(), rows.end(), Index{0});
  for (std::size_t f = 0; f < analysis.response.numbers.size(); ++f) {
    if (f == analysis.x || f == analysis.y) continue;
    const double usual = UsualOf(group, f);
    std::erase_if(rows, [&](Index i) { return group.x(i, static_cast<Index>(f)) != usual; });
  }
  return rows;
}

ChartSeries LineAt(const SweepAnalysis& analysis, const ResponseGroup& group, double y, int look) {
  const auto& numbers = analysis.response.numbers;
  ChartSeries series{.name = group.Name(),
                     .style = ChartSeries::Style::kLineWithPoints,
                     .look = look,
                     .points = {}};
  const bool has_y = analysis.y < numbers.size();
  if (has_y) {
    series.name += fmt::format("{}{} = {:.3g}", series.name.empty() ? "" : ", ",
                               numbers[analysis.y].key, numbers[analysis.y].Decode(y));
  }
  for (const Index i : RowsOfTheMap(analysis, group)) {
    if (has_y && group.x(i, static_cast<Index>(analysis.y)) != y) continue;
    const double value = group.y[i], width = 1.96 * group.sigma[i];
    series.points.push_back(
        {.x = numbers[analysis.x].Decode(group.x(i, static_cast<Index>(analysis.x))),
         .y = value,
         .low = value - width,
         .high = value + width});
  }
  std::sort(series.points.begin(), series.points.end(),
            [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
  return series;
}

}  // namespace

std::vector<Figure> LineFigures(const SweepPlan&, const SweepAnalysis& analysis) {
  const Response& response = analysis.response;
  if (analysis.x >= response.numbers.size()) return {};
  std::vector<Figure> figures;
  for (std::size_t g = 0; g < response.groups.size(); ++g) {
    const ResponseGroup& group = response.groups[g];
    Chart chart{.title = response.metric + (group.words.empty() ? "" : ", " + group.Name()),
                .x_label = response.numbers[analysis.x].key,
                .y_label = response.metric,
                .series = {}};
    const bool has_y = analysis.y < response.numbers.size();
    const auto values = has_y ? ThreeOf(group, analysis.y) : std::vector<double>{0};
    for (const double y : values) {
      ChartSeries series = LineAt(analysis, group, y, static_cast<int>(chart.series.size()));
      if (series.points.size() > 1) chart.series.push_back(std::move(series));
    }
    if (chart.series.empty()) continue;
    if (analysis.limit) {
      chart.series.push_back({.name = fmt::format("limit {:g}", *analysis.limit),
                              .look = -1,
                              .points = {{response.numbers[analysis.x].low, *analysis.limit},
                                         {response.numbers[analysis.x].high, *analysis.limit}}});
    }
    figures.push_back({fmt::format("lines_{}", g), chart.title, ChartFileSvg(chart)});
  }
  return figures;
}

std::vector<Figure> ParetoFigures(const SweepPlan& plan, const SweepAnalysis& analysis) {
  if (analysis.all.empty()) return {};
  Chart chart{.title = "What one metric costs in the other; the line joins the best",
              .x_label = plan.config.analysis.pareto[0],
              .y_label = plan.config.analysis.pareto[1],
              .series = {}};
  ChartSeries all{.name = "points", .style = ChartSeries::Style::kPoints, .look = 0, .points = {}};
  for (const ParetoPoint& point : analysis.all) all.points.push_back({point.a, point.b});
  ChartSeries front{.name = "Pareto front",
                    .style = ChartSeries::Style::kLineWithPoints,
                    .look = 1,
                    .points = {}};
  for (const ParetoPoint& point : analysis.front) front.points.push_back({point.a, point.b});
  chart.series = {std::move(all), std::move(front)};
  return {{"pareto", chart.title, ChartFileSvg(chart)}};
}

std::vector<Figure> SweepFigures(const SweepPlan& plan, const SweepAnalysis& analysis) {
  std::vector<Figure> all;
  for (auto& figures :
       {MapFigures(plan, analysis), LineFigures(plan, analysis), TornadoFigures(analysis),
        IndexFigures(analysis), ParetoFigures(plan, analysis)}) {
    all.insert(all.end(), figures.begin(), figures.end());
  }
  return all;
}

}  // namespace windhover
