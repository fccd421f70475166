#pragma once

#include <string>
#include <vector>

#include "eval/gates.h"
#include "sweep/sweep_analysis.h"
#include "sweep/sweep_figures.h"

namespace windhover {

/// The report of a sweep as one HTML page that needs no network: gates, figures, what keeps within
/// the limit, surfaces, and a plot whose axes the reader chooses.
std::string SweepReport(const SweepPlan& plan, const std::vector<PointSummary>& points,
                        const std::vector<GateResult>& gates, const SweepAnalysis& analysis,
                        const std::vector<Figure>& figures);

}  // namespace windhover
