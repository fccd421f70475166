#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "eval/gates.h"
#include "sweep/journal.h"
#include "sweep/sweep_plan.h"

namespace windhover {

/// A metric over the runs of a point.
struct MetricSummary {
  int n = 0;  ///< Valid runs that have a value.
  std::optional<double> mean = {};
  std::optional<std::array<double, 2>> ci95 = {};  ///< Of the mean: resamples runs.
};

struct PointSummary {
  int point = 0;
  int n_runs = 0, n_failed = 0, n_invalid = 0;
  std::vector<MetricSummary> metrics = {};  ///< Those of the plan.
};

/// Mean and interval of values, those that there are.
MetricSummary Summarise(const std::vector<std::optional<double>>& values);

/// One for each point that has runs, in order.
std::vector<PointSummary> SummarisePoints(const SweepPlan& plan, const RunRows& rows);

/// The content of table.csv, one row a run: point, seed, factors, verdict, metrics. Numbers read
/// back as they were; what a run has not is empty.
std::string TableCsv(const SweepPlan& plan, const RunRows& rows);

/// The content of points.csv, one row a point: factors, counts of runs, and of each metric mean,
/// ends of the 95 % interval, and runs that have it.
std::string PointsCsv(const SweepPlan& plan, const std::vector<PointSummary>& points);

/// The sweep's gates at every point that they are for; `name` says which.
std::vector<GateResult> EvaluateSweepGates(const SweepPlan& plan,
                                           const std::vector<PointSummary>& points);

/// Whether a point needs no more runs, after these values of the stop rule's metric.
bool IsNarrowEnough(const StopConfig& stop, const std::vector<std::optional<double>>& values);

}  // namespace windhover
