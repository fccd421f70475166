#include "eval/evaluation.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "camera/stereo_rig.h"
#include "eval/score_json.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

FrameCounts CountFrames(const RunRecord& run) {
  FrameCounts counts;
  counts.sent = static_cast<int>(run.frames.size());
  for (const ObserverFrame& frame : run.frames) counts.received += frame.ranges.has_value();
  return counts;
}

std::vector<std::vector<ScoredFrame>> FramesOfMethods(const TargetFrames& targets,
                                                      std::size_t n_methods) {
  std::vector<std::vector<ScoredFrame>> frames(n_methods);
  for (const TargetFrame& target : targets.frames) {
    for (std::size_t m = 0; m < n_methods; ++m) {
      ScoredFrame scored{
          .utime = target.utime, .reference_m = target.reference_m, .estimate_m = {}, .sigma_m = 0};
      if (target.estimates[m]) {
        scored.estimate_m = target.estimates[m]->range_m;
        scored.sigma_m = target.estimates[m]->range_sigma_m;
      }
      frames[m].push_back(scored);
    }
  }
  return frames;
}

/// Disparity of a pair of box centres on undistorted image planes, px.
std::optional<double> Disparity_px(const StereoRig& rig, const stereo_box_t& box) {
  const auto left = rig.left.Unproject({box.left.x_px, box.left.y_px});
  const auto right = rig.right.Unproject({box.right.x_px, box.right.y_px});
  if (!left || !right || left->z() <= 0 || right->z() <= 0) return std::nullopt;
  return rig.left.fx_px() * (left->x() / left->z() - right->x() / right->z());
}

std::optional<double> MedianDisparityOffset_px(const RunRecord& run, const TargetFrames& targets) {
  const StereoRig rig = run.scenario.rig.calibrated.ToStereoRig();
  std::vector<double> offsets_px;
  for (const TargetFrame& target : targets.frames) {
    if (!target.box || !(target.truth.depth_m > 0)) continue;
    const auto measured_px = Disparity_px(rig, *target.box);
    if (!measured_px) continue;
    offsets_px.push_back(*measured_px - rig.left.fx_px() * rig.baseline_m / target.truth.depth_m);
  }
  return Median(std::move(offsets_px));
}

// The launcher may know what the log cannot: that a process died after its last message, or why
// the log just stops.
void TakeValidity(const Json& manifest, RunRecord* run) {
  if (!manifest.is_object() || manifest.value("valid", true)) return;
  run->valid = false;
  run->invalid_reason =
      fmt::format("{}: {}", manifest.value("culprit", ""), manifest.value("invalid_reason", ""));
}

std::string Verdict(const RunRecord& run, const std::vector<GateResult>& gates) {
  if (!run.valid) return "invalid";
  const bool all_pass = std::all_of(gates.begin(), gates.end(), [](auto& g) { return g.pass; });
  return all_pass ? "pass" : "fail";
}

}  // namespace

Evaluation EvaluateRecord(RunRecord run, Json timing, Json manifest) {
  Evaluation evaluation;
  evaluation.run = std::move(run);
  evaluation.timing = std::move(timing);
  evaluation.manifest = std::move(manifest);
  TakeValidity(evaluation.manifest, &evaluation.run);
  const Scenario& scenario = evaluation.run.scenario;
  evaluation.frames = CountFrames(evaluation.run);
  if (evaluation.run.valid && evaluation.frames.lost() != 0) {
    evaluation.run.valid = false;
    evaluation.run.invalid_reason =
        fmt::format("{} of {} stereo frames have no RANGE message in the log",
                    evaluation.frames.lost(), evaluation.frames.sent);
  }
  evaluation.targets = CollectTargetFrames(evaluation.run);
  const auto& methods = scenario.estimator.methods;
  evaluation.methods = ScoreMethods(methods, FramesOfMethods(evaluation.targets, methods.size()),
                                    1 / scenario.frame_rate_hz, scenario.random_seed);
  evaluation.swarm_ticks = SwarmTicks(evaluation.run);
  evaluation.swarm = ComputeSwarmMetrics(evaluation.run, evaluation.swarm_ticks);
  evaluation.disparity_offset_px = MedianDisparityOffset_px(evaluation.run, evaluation.targets);
  evaluation.score = ScoreJson(evaluation);
  evaluation.gates = EvaluateGates(evaluation.score, scenario.expect);
  evaluation.verdict = Verdict(evaluation.run, evaluation.gates);
  AddVerdict(evaluation, &evaluation.score);
  return evaluation;
}

}  // namespace windhover
