#include "sweep/sweep_analysis.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::optional<double>& number) { return number ? Json(*number) : Json(nullptr); }

Json LargestJson(const SweepAnalysis& analysis, const GroupAnalysis& group) {
  Json list = Json::array();
  for (const LargestValue& largest : group.largest) {
    Json json = Json::object();
    if (analysis.response.numbers.size() > 1) {
      json[analysis.response.numbers[analysis.y].key] = largest.y;
    }
    json["largest"] = OrNull(largest.x);
    json["largest_for_sure"] = OrNull(largest.sure_x);
    json["is_end_of_range"] = largest.is_end;
    list.push_back(json);
  }
  return list;
}

Json GroupJson(const SweepAnalysis& analysis, std::size_t g) {
  const GroupAnalysis& group = analysis.groups[g];
  Json terms = Json::object(), lengths = Json::object();
  for (const auto& term : group.quadratic.terms) terms[term.name] = term.coefficient;
  Json json = {{"words", analysis.response.groups[g].words},
               {"points", analysis.response.groups[g].y.size()}};
  if (!terms.empty()) {
    json["quadratic"] = {{"r_squared", group.quadratic.r_squared},
                         {"leave_one_out_rmse", group.quadratic.leave_one_out_rmse},
                         {"coded_coefficients", terms}};
  }
  if (group.surface) {
    for (std::size_t i = 0; i < analysis.response.numbers.size(); ++i) {
      lengths[analysis.response.numbers[i].key] =
          group.surface->length_scales()[static_cast<Eigen::Index>(i)];
    }
    json["gaussian_process"] = {{"leave_one_out_rmse", group.surface->leave_one_out_rmse()},
                                {"coded_length_scales", lengths}};
  }
  if (!group.largest.empty()) json["within_limit"] = LargestJson(analysis, group);
  return json;
}

}  // namespace

Json AnalysisJson(const SweepPlan& plan, const SweepAnalysis& analysis) {
  Json json = {{"metric", analysis.response.metric}, {"limit", OrNull(analysis.limit)}};
  const auto& numbers = analysis.response.numbers;
  if (analysis.x < numbers.size()) json["x"] = numbers[analysis.x].key;
  json["groups"] = Json::array();
  for (std::size_t g = 0; g < analysis.groups.size(); ++g) {
    json["groups"].push_back(GroupJson(analysis, g));
  }
  json["sobol_indices"] = Json::object();
  for (std::size_t i = 0; i < analysis.indices.first.size(); ++i) {
    json["sobol_indices"][analysis.keys[i]] = {{"first", analysis.indices.first[i]},
                                               {"total", analysis.indices.total[i]}};
  }
  json["effects"] = Json::array();
  for (const FactorEffect& effect : analysis.effects) {
    json["effects"].push_back({{"key", effect.key},
                               {"low", effect.low},
                               {"high", effect.high},
                               {"at_low", effect.at_low},
                               {"at_high", effect.at_high}});
  }
  if (plan.config.analysis.pareto.size() != 2) return json;
  json["pareto"] = Json::array();
  for (const ParetoPoint& point : analysis.front) {
    json["pareto"].push_back({{"point", point.point},
                              {plan.config.analysis.pareto[0], point.a},
                              {plan.config.analysis.pareto[1], point.b},
                              {"at", plan.Describe(static_cast<std::size_t>(point.point))}});
  }
  return json;
}

}  // namespace windhover
