#pragma once

#include <string>

#include "eval/evaluation.h"

namespace windhover {

/// Mean relative error of each method in bins of distance, with 95 % intervals.
std::string ErrorByDistanceChart(const Evaluation& evaluation);

/// Reference and estimates over time, one chart for each observer and target (at most four).
std::string RangeOverTimeCharts(const Evaluation& evaluation);

}  // namespace windhover
