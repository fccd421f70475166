#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "sweep/sweep_table.h"

namespace windhover {

/// A factor of numbers, coded to [0, 1] over the values that were flown.
struct CodedFactor {
  std::size_t factor = 0;  ///< Of the plan.
  std::string key;
  double low = 0, high = 1;
  bool is_log = false;

  double Code(double value) const;
  double Decode(double coded) const;
};

/// Points that have the same words (materials, presets, …).
struct ResponseGroup {
  std::vector<std::string> words;  ///< Of the factors of words, in their order.
  Eigen::MatrixXd x;               ///< One point a row, coded.
  Eigen::VectorXd y;               ///< Means of the response.
  Eigen::VectorXd sigma;           ///< Their standard errors; 0 where there is one run.

  std::string Name() const;  ///< "a, b"; empty if there are no words.
};

/// A metric at the points of a sweep as a function of its factors.
struct Response {
  std::string metric;
  std::vector<CodedFactor> numbers;
  std::vector<std::size_t> words;  ///< Of the plan's factors.
  std::vector<ResponseGroup> groups;
};

/// @param metric index of one of the plan's. Points without a value are left out, and groups of
/// fewer than two points.
Response MakeResponse(const SweepPlan& plan, const std::vector<PointSummary>& points,
                      std::size_t metric);

}  // namespace windhover
