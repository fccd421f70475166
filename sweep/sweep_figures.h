#pragma once

#include <string>
#include <vector>

#include "eval/svg_chart.h"
#include "sweep/sweep_analysis.h"

namespace windhover {

/// A drawing for the report and for a file of its own.
struct Figure {
  std::string name;  ///< Of its file, without ending.
  std::string title;
  std::string svg;  ///< A whole <svg>, which needs nothing else.
};

/// The response over the map's two factors as colours, the limit's contour, and the points that
/// were flown: one for each combination of words. None without two factors of numbers.
std::vector<Figure> MapFigures(const SweepPlan& plan, const SweepAnalysis& analysis);

/// First and total Sobol indices as bars.
std::vector<Figure> IndexFigures(const SweepAnalysis& analysis);

/// Tornado: what each factor does between its low and its high value.
std::vector<Figure> TornadoFigures(const SweepAnalysis& analysis);

/// Every point's two metrics, and the front.
std::vector<Figure> ParetoFigures(const SweepPlan& plan, const SweepAnalysis& analysis);

/// Means and intervals over the map's first factor, one line for each combination of words at the
/// second factor's smallest, middle and largest value.
std::vector<Figure> LineFigures(const SweepPlan& plan, const SweepAnalysis& analysis);

/// All of them.
std::vector<Figure> SweepFigures(const SweepPlan& plan, const SweepAnalysis& analysis);

}  // namespace windhover
