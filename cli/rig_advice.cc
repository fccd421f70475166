#include "cli/rig_advice.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/config/config_reader.h"
#include "common/config/config_tree.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

BudgetPlan PlanOf(const RigRequirement& require) {
  BudgetPlan plan;
  plan.distances_m = {require.distance_m};
  plan.n_flights = require.flights;
  // On the axis: a narrow lens does not show what is beside it.
  plan.right_deg = plan.down_deg = 0;
  return plan;
}

/// Biases summed, deviations by root of sum of squares, as in the budget.
Effect FirstOrder(const Scenario& scenario, const BudgetPlan& plan, bool* is_small) {
  Effect sum;
  const Sight sight = SightAt(scenario, plan, plan.distances_m.front());
  double left_out = 0;
  for (const ErrorSource& source : ErrorSourcesOf(scenario)) {
    const Effect effect = source.first_order(scenario, sight);
    sum.bias_m += effect.bias_m;
    sum.sigma_m = std::hypot(sum.sigma_m, effect.sigma_m);
    left_out = std::max(left_out, effect.left_out);
  }
  *is_small = left_out <= kSmall;
  return sum;
}

RigAdvice Judge(const AdviceRequest& request, std::size_t point) {
  RigAdvice rig{.point = point, .first_order = {}};
  Scenario scenario = request.rigs.ScenarioAt(point);
  scenario.random_seed = request.rigs.SeedOf(0);
  const CalibratedRig& calibrated = scenario.rig.calibrated;
  rig.field_of_view_deg =
      2 * std::atan(calibrated.image[0] / 2.0 / calibrated.FocalPx()) * 180 / std::numbers::pi;
  const BudgetPlan plan = PlanOf(request.require);
  rig.first_order = FirstOrder(scenario, plan, &rig.is_small);
  rig.abs_rel = MeanAbsolute_m(rig.first_order) / request.require.distance_m;
  return rig;
}

void Confirm(const AdviceRequest& request, RigAdvice* rig) {
  Scenario scenario = request.rigs.ScenarioAt(rig->point);
  scenario.random_seed = request.rigs.SeedOf(0);
  rig->simulated = Simulate(scenario, PlanOf(request.require)).effects.front();
  rig->simulated_abs_rel = MeanAbsolute_m(rig->simulated) / request.require.distance_m;
  rig->is_simulated = true;
}

}  // namespace

AdviceRequest LoadAdviceRequest(const std::filesystem::path& file) {
  AdviceRequest request;
  ConfigNode root = LoadConfigTree(file);
  const ConfigNode require = TakeNode(root, "require");
  Findings findings;
  if (require.IsMap()) {
    ReadConfig(require, request.require, findings);
  } else {
    findings.MustBe(require.IsMap() ? require.where : root.where, "require", "a map",
                    require.Found());
  }
  findings.ThrowIfAny();
  request.rigs = SweepPlanOf(std::move(root));
  return request;
}

double MeanAbsolute_m(const Effect& effect) {
  const double b = std::abs(effect.bias_m), s = effect.sigma_m;
  if (s == 0) return b;
  return s * std::sqrt(2 / std::numbers::pi) * std::exp(-b * b / (2 * s * s)) +
         b * std::erf(b / (s * std::numbers::sqrt2));
}

std::vector<RigAdvice> Advise(const AdviceRequest& request) {
  std::vector<RigAdvice> rigs;
  for (std::size_t i = 0; i < request.rigs.points.size(); ++i) {
    RigAdvice rig = Judge(request, i);
    if (rig.field_of_view_deg >= request.require.field_of_view_deg) rigs.push_back(rig);
  }
  std::stable_sort(rigs.begin(), rigs.end(),
                   [](const RigAdvice& a, const RigAdvice& b) { return a.abs_rel < b.abs_rel; });
  const auto n = std::min(rigs.size(), static_cast<std::size_t>(request.require.confirm));
  for (std::size_t i = 0; i < n; ++i) Confirm(request, &rigs[i]);
  return rigs;
}

bool Meets(const AdviceRequest& request, const RigAdvice& rig) {
  return (rig.is_simulated ? rig.simulated_abs_rel : rig.abs_rel) <= request.require.abs_rel;
}

Json AdviceJson(const AdviceRequest& request, const std::vector<RigAdvice>& rigs) {
  const RigRequirement& require = request.require;
  Json json = {{"require",
                {{"abs_rel", require.abs_rel},
                 {"distance_m", require.distance_m},
                 {"field_of_view_deg", require.field_of_view_deg}}},
               {"rigs", Json::array()}};
  for (const RigAdvice& rig : rigs) {
    Json choice = Json::object();
    for (std::size_t f = 0; f < request.rigs.factors.size(); ++f) {
      choice[request.rigs.factors[f].key()] = request.rigs.points[rig.point][f];
    }
    json["rigs"].push_back(
        {{"rig", choice},
         {"field_of_view_deg", rig.field_of_view_deg},
         {"bias_m", rig.first_order.bias_m},
         {"sigma_m", rig.first_order.sigma_m},
         {"abs_rel", rig.abs_rel},
         {"is_small", rig.is_small},
         {"simulated_abs_rel", rig.is_simulated ? Json(rig.simulated_abs_rel) : Json(nullptr)},
         {"meets", Meets(request, rig)}});
  }
  return json;
}

}  // namespace windhover
