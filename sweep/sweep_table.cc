#include "sweep/sweep_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "common/config/config_node.h"
#include "eval/bootstrap.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kBootstrapSeed = 1;

std::string Cell(const std::optional<double>& number) {
  return number ? fmt::format("{}", *number) : "";
}

/// Quoted where a comma or a quote would be taken for more.
std::string Cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string FactorCells(const SweepPlan& plan, int point) {
  std::string cells;
  for (const std::string& value : plan.points[static_cast<std::size_t>(point)]) {
    cells += "," + Cell(value);
  }
  return cells;
}

std::string FactorNames(const SweepPlan& plan) {
  std::string names;
  for (const Factor& factor : plan.factors) names += "," + factor.key();
  return names;
}

bool IsFor(const SweepGate& gate, const SweepPlan& plan, int point) {
  if (gate.where.empty()) return true;
  const auto value =
      NumberOf(plan.points[static_cast<std::size_t>(point)][plan.FactorNamed(gate.where)]);
  const double x = value.value_or(kUnset);
  return !(x < gate.from) && !(x > gate.to);  // False for a limit that is not given.
}

/// A point in the form of score.json, so that gates read it as they read a run.
Json ScoreOf(const SweepPlan& plan, const PointSummary& point) {
  Json score = Json::object();
  for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
    const MetricSummary& metric = point.metrics[m];
    const std::vector<std::string> parts = SplitPath(plan.metrics[m]);
    Json* at = &score;
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) at = &(*at)[parts[i]];
    (*at)[parts.back()] = metric.mean ? Json(*metric.mean) : Json(nullptr);
    if (metric.ci95) (*at)["ci95"][parts.back()] = *metric.ci95;
  }
  return score;
}

}  // namespace

MetricSummary Summarise(const std::vector<std::optional<double>>& values) {
  MetricSummary summary;
  std::vector<BlockSum> runs;
  double sum = 0;
  for (const auto& value : values) {
    if (!value) continue;
    sum += *value;
    runs.push_back({*value, 1});
  }
  summary.n = static_cast<int>(runs.size());
  if (summary.n == 0) return summary;
  summary.mean = sum / summary.n;
  summary.ci95 = BootstrapInterval95(runs, kBootstrapSeed);
  return summary;
}

std::vector<PointSummary> SummarisePoints(const SweepPlan& plan, const RunRows& rows) {
  std::vector<PointSummary> points;
  for (auto row = rows.begin(); row != rows.end();) {
    PointSummary& point = points.emplace_back();
    point.point = row->first.first;
    std::vector<std::vector<std::optional<double>>> values(plan.metrics.size());
    for (; row != rows.end() && row->first.first == point.point; ++row) {
      ++point.n_runs;
      if (row->second.verdict == "fail") ++point.n_failed;
      if (!row->second.valid()) {
        ++point.n_invalid;
        continue;
      }
      for (std::size_t m = 0; m < values.size(); ++m) values[m].push_back(row->second.metrics[m]);
    }
    for (const auto& of_metric : values) point.metrics.push_back(Summarise(of_metric));
  }
  return points;
}

std::string TableCsv(const SweepPlan& plan, const RunRows& rows) {
  std::string csv = "point,seed" + FactorNames(plan) + ",verdict";
  for (const std::string& metric : plan.metrics) csv += "," + metric;
  csv += "\n";
  for (const auto& [key, row] : rows) {
    csv +=
        fmt::format("{},{}{},{}", row.point, row.seed, FactorCells(plan, row.point), row.verdict);
    for (std::size_t m = 0; m < plan.metrics.size(); ++m) {
      csv += "," + (row.valid() ? Cell(row.metrics[m]) : "");
    }
    csv += "\n";
  }
  return csv;
}

std::string PointsCsv(const SweepPlan& plan, const std::vector<PointSummary>& points) {
  std::string csv = "point" + FactorNames(plan) + ",runs,failed,invalid";
  for (const std::string& metric : plan.metrics) {
    csv += fmt::format(",{0},{0}.low95,{0}.high95,{0}.n", metric);
  }
  csv += "\n";
  for (const PointSummary& point : points) {
    csv += fmt::format("{}{},{},{},{}", point.point, FactorCells(plan, point.point), point.n_runs,
                       point.n_failed, point.n_invalid);
    for (const MetricSummary& metric : point.metrics) {
      csv += "," + Cell(metric.mean);
      for (const std::size_t end : {0, 1}) {
        csv += "," + (metric.ci95 ? Cell(std::optional((*metric.ci95)[end])) : "");
      }
      csv += fmt::format(",{}", metric.n);
    }
    csv += "\n";
  }
  return csv;
}

std::vector<GateResult> EvaluateSweepGates(const SweepPlan& plan,
                                           const std::vector<PointSummary>& points) {
  std::vector<GateResult> results;
  for (const PointSummary& point : points) {
    std::vector<Expectation> expectations;
    for (const SweepGate& gate : plan.config.gates) {
      if (IsFor(gate, plan, point.point)) expectations.push_back(gate.expectation);
    }
    if (expectations.empty()) continue;
    for (GateResult& result : EvaluateGates(ScoreOf(plan, point), expectations)) {
      const std::string where = plan.Describe(static_cast<std::size_t>(point.point));
      result.name += where.empty() ? "" : " at " + where;
      results.push_back(std::move(result));
    }
  }
  return results;
}

bool IsNarrowEnough(const StopConfig& stop, const std::vector<std::optional<double>>& values) {
  if (stop.metric.empty() || static_cast<int>(values.size()) < stop.min_seeds) return false;
  const MetricSummary summary = Summarise(values);
  return summary.ci95 && summary.n >= stop.min_seeds &&
         (*summary.ci95)[1] - (*summary.ci95)[0] <= stop.width;
}

}  // namespace windhover
