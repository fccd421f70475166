#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "sweep/gaussian_process.h"
#include "sweep/quadratic_surface.h"
#include "sweep/response.h"
#include "sweep/response_map.h"
#include "sweep/sobol_indices.h"

namespace windhover {

/// Effect of one factor on the response while the others stay at their middle.
struct FactorEffect {
  std::string key;
  std::string low, high;  ///< The values between which it was.
  double at_low = 0, at_high = 0;
};

/// How large x may be for the response to stay within the limit.
struct LargestValue {
  double y;                           ///< Value of the map's second factor.
  std::optional<double> x = {};       ///< Nothing: not even the smallest x.
  std::optional<double> sure_x = {};  ///< The same of mean + 1.96 sigma of the Gaussian process.
  bool is_end = false;                ///< x is the largest that was flown: it may be larger.
};

/// What is known of one combination of words.
struct GroupAnalysis {
  std::string name;
  std::shared_ptr<const GaussianProcess> surface;
  QuadraticSurface quadratic;
  ResponseMap map;                    ///< Over x and y; empty without two factors of numbers.
  std::vector<LargestValue> largest;  ///< For each y that was flown; empty without a limit.
};

struct ParetoPoint {
  int point;
  double a, b;
};

struct SweepAnalysis {
  Response response;
  std::size_t x = 0, y = 1;  ///< Of response.numbers: the map's axes.
  std::optional<double> limit;
  std::vector<GroupAnalysis> groups;
  std::vector<std::string> keys;  ///< Of the factors that the indices are of.
  SobolIndices indices;           ///< Of the surfaces; empty if there are too few points.
  std::vector<FactorEffect> effects;
  std::vector<ParetoPoint> all, front;  ///< Of analysis.pareto.
};

/// Surfaces are fitted for each combination of words by itself; indices and effects are those of
/// the surfaces, with factors distributed as the sweep says.
SweepAnalysis AnalyseSweep(const SweepPlan& plan, const std::vector<PointSummary>& points);

/// The content of analysis.json.
nlohmann::ordered_json AnalysisJson(const SweepPlan& plan, const SweepAnalysis& analysis);

}  // namespace windhover
