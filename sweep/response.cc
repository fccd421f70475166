#include "sweep/response.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "eval/bootstrap.h"

namespace windhover {
namespace {

double NumberAt(const SweepPlan& plan, const PointSummary& point, std::size_t factor) {
  return NumberOf(plan.points[static_cast<std::size_t>(point.point)][factor]).value_or(0);
}

CodedFactor Coded(const SweepPlan& plan, const std::vector<PointSummary>& points,
                  std::size_t factor) {
  CodedFactor coded{.factor = factor,
                    .key = plan.factors[factor].key(),
                    .low = INFINITY,
                    .high = -INFINITY,
                    .is_log = plan.factors[factor].scale() == FactorScale::kLog};
  for (const PointSummary& point : points) {
    coded.low = std::min(coded.low, NumberAt(plan, point, factor));
    coded.high = std::max(coded.high, NumberAt(plan, point, factor));
  }
  return coded;
}

/// Of a mean, from its interval.
double StandardError(const MetricSummary& metric) {
  if (!metric.ci95 || metric.n < 2) return 0;
  return ((*metric.ci95)[1] - (*metric.ci95)[0]) / (2 * StudentT975(metric.n - 1));
}

ResponseGroup MakeGroup(const SweepPlan& plan, const std::vector<CodedFactor>& numbers,
                        const std::vector<const PointSummary*>& points, std::size_t metric) {
  ResponseGroup group;
  const auto n = static_cast<Eigen::Index>(points.size());
  group.x.resize(n, static_cast<Eigen::Index>(numbers.size()));
  group.y.resize(n);
  group.sigma.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PointSummary& point = *points[static_cast<std::size_t>(i)];
    for (std::size_t f = 0; f < numbers.size(); ++f) {
      group.x(i, static_cast<Eigen::Index>(f)) =
          numbers[f].Code(NumberAt(plan, point, numbers[f].factor));
    }
    group.y[i] = *point.metrics[metric].mean;
    group.sigma[i] = StandardError(point.metrics[metric]);
  }
  return group;
}

}  // namespace

double CodedFactor::Code(double value) const {
  if (!(high > low)) return 0.5;
  if (is_log) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

double CodedFactor::Decode(double coded) const {
  if (is_log) return low * std::pow(high / low, coded);
  return low + coded * (high - low);
}

std::string ResponseGroup::Name() const {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "" : ", ") + word;
  return name;
}

Response MakeResponse(const SweepPlan& plan, const std::vector<PointSummary>& points,
                      std::size_t metric) {
  Response response{.metric = plan.metrics[metric], .numbers = {}, .words = {}, .groups = {}};
  for (std::size_t f = 0; f < plan.factors.size(); ++f) {
    if (plan.factors[f].is_number()) {
      response.numbers.push_back(Coded(plan, points, f));
    } else {
      response.words.push_back(f);
    }
  }
  // In the order in which the design has them.
  std::vector<std::vector<std::string>> names;
  std::map<std::vector<std::string>, std::vector<const PointSummary*>> members;
  for (const PointSummary& point : points) {
    if (!point.metrics[metric].mean) continue;
    std::vector<std::string> words;
    for (const std::size_t f : response.words) {
      words.push_back(plan.points[static_cast<std::size_t>(point.point)][f]);
    }
    if (members[words].empty()) names.push_back(words);
    members[words].push_back(&point);
  }
  for (const auto& words : names) {
    if (members[words].size() < 2) continue;
    response.groups.push_back(MakeGroup(plan, response.numbers, members[words], metric));
    response.groups.back().words = words;
  }
  return response;
}

}  // namespace windhover
