#include "eval/score_json.h"

#include <cmath>

#include "common/config/enum_name.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

template <typename Number>
Json NumberOrNull(const std::optional<Number>& number) {
  if (!number || !std::isfinite(static_cast<double>(*number))) return nullptr;
  return *number;
}

Json IntervalsJson(const std::map<std::string, std::array<double, 2>>& ci95) {
  Json json = Json::object();
  for (const auto& [name, interval] : ci95) json[name] = interval;
  return json;
}

Json MetricsJson(const ErrorMetrics& metrics) {
  return {{"n", metrics.n},
          {"detected", metrics.detected},
          {"abs_rel_all", NumberOrNull(metrics.abs_rel_all)},
          {"abs_rel", NumberOrNull(metrics.abs_rel)},
          {"sq_rel", NumberOrNull(metrics.sq_rel)},
          {"rmse_m", NumberOrNull(metrics.rmse_m)},
          {"bias_m", NumberOrNull(metrics.bias_m)},
          {"delta_1_25", NumberOrNull(metrics.delta_1_25)},
          {"nees", NumberOrNull(metrics.nees)},
          {"coverage_95", NumberOrNull(metrics.coverage_95)},
          {"ci95", IntervalsJson(metrics.ci95)}};
}

Json DistanceBinJson(const DistanceBin& bin) {
  Json json = {{"from_m", bin.from_m}, {"to_m", bin.to_m}};
  json.update(MetricsJson(bin.metrics));
  return json;
}

Json MethodJson(const MethodScore& method) {
  Json json = MetricsJson(method.all);
  json["by_distance"] = Json::array();
  for (const DistanceBin& bin : method.by_distance) {
    json["by_distance"].push_back(DistanceBinJson(bin));
  }
  json["lt20"] = MetricsJson(method.lt20);
  json["gt20"] = MetricsJson(method.gt20);
  json["shared"] = MetricsJson(method.shared);
  return json;
}

Json SwarmJson(const SwarmMetrics& swarm) {
  return {{"min_separation_m", NumberOrNull(swarm.min_separation_m)},
          {"collisions", NumberOrNull(swarm.collisions)},
          {"near_misses", NumberOrNull(swarm.near_misses)},
          {"order", NumberOrNull(swarm.order)},
          {"connectivity", NumberOrNull(swarm.connectivity)},
          {"algebraic_connectivity", NumberOrNull(swarm.algebraic_connectivity)},
          {"union_by_sight", NumberOrNull(swarm.union_by_sight)},
          {"guarded", NumberOrNull(swarm.guarded)},
          {"false_brakes", NumberOrNull(swarm.false_brakes)},
          {"missed_brakes", NumberOrNull(swarm.missed_brakes)},
          {"first_sight_to_near_miss_s", NumberOrNull(swarm.first_sight_to_near_miss_s)},
          {"track_purity", NumberOrNull(swarm.track_purity)},
          {"ci95", IntervalsJson(swarm.ci95)}};
}

Json GateJson(const GateResult& gate) {
  Json json = {{"name", gate.name},
               {"metric", gate.metric},
               {"kind", gate.kind},
               {"limit", gate.limit},
               {"value", NumberOrNull(gate.value)},
               {"pass", gate.pass}};
  if (!gate.message.empty()) json["message"] = gate.message;
  return json;
}

/// The keys of timing.json that score.json repeats.
Json TimingJson(const Json& timing) {
  if (!timing.is_object()) return nullptr;
  Json json = Json::object();
  for (const char* key : {"real_time_factor", "stereo_pairs_per_s", "ms", "peak_rss_mib"}) {
    if (timing.contains(key)) json[key] = timing[key];
  }
  return json;
}

}  // namespace

Json MethodsJson(const std::vector<MethodScore>& methods) {
  Json json = Json::object();
  for (const MethodScore& method : methods) json[method.method] = MethodJson(method);
  return json;
}

Json ScoreJson(const Evaluation& evaluation) {
  const RunRecord& run = evaluation.run;
  Json methods = MethodsJson(evaluation.methods);
  if (methods.contains("baseline")) {
    methods["baseline"]["disparity_offset_px"] = NumberOrNull(evaluation.disparity_offset_px);
  }
  return {{"scenario", run.scenario.description},
          {"seed", run.scenario.random_seed},
          {"version", run.version},
          {"reference", NameOf(run.scenario.score.reference)},
          {"valid", run.valid},
          {"verdict", nullptr},
          {"invalid_reason", run.invalid_reason},
          {"frames",
           {{"sent", evaluation.frames.sent},
            {"received", evaluation.frames.received},
            {"lost", evaluation.frames.lost()},
            {"targets_in_view", evaluation.targets.frames.size()},
            {"without_reference", evaluation.targets.no_reference},
            {"false_detections", evaluation.targets.false_detections}}},
          {"methods", methods},
          {"swarm", SwarmJson(evaluation.swarm)},
          {"timing", TimingJson(evaluation.timing)},
          {"gates", Json::array()}};
}

void AddVerdict(const Evaluation& evaluation, Json* score) {
  (*score)["verdict"] = evaluation.verdict;
  for (const GateResult& gate : evaluation.gates) (*score)["gates"].push_back(GateJson(gate));
}

}  // namespace windhover
