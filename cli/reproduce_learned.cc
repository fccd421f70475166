#include "cli/reproduce_learned.h"

#include <cmath>

#include <fmt/format.h>

#include "eval/bootstrap.h"
#include "learn/audit.h"
#include "learn/tuple_source.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;
using Overrides = std::vector<std::string>;

Scenario Base(const std::string& preset, const Overrides& overrides,
              const std::filesystem::path& scenarios) {
  return BaseOf({.method = "", .preset = preset, .overrides = overrides}, scenarios);
}

const Overrides kUnseen = {
    "rig.misalignment.offset_px=55", "geometric.sigma_px=1.2", "geometric.sigma_relative=0.02",
    "aircraft=[{id: 0, type: p600, carries_rig: true, position_m: [0, 0, 20]}, "
    "{id: 1, type: p600}]"};

/// Student's t over data sets.
Json MeanOver(const std::vector<double>& sets) {
  const auto n = static_cast<double>(sets.size());
  double sum = 0, squares = 0;
  for (const double x : sets) sum += x;
  const double mean = sum / n;
  for (const double x : sets) squares += (x - mean) * (x - mean);
  Json json = {{"mean", mean}};
  if (sets.size() > 1) {
    const double half = StudentT975(static_cast<int>(n) - 1) * std::sqrt(squares / (n - 1) / n);
    json["ci95"] = {mean - half, mean + half};
  }
  return json;
}

Json GainOver(const std::vector<double>& scratch, const std::vector<double>& pretrained) {
  std::vector<double> gains;
  for (std::size_t i = 0; i < scratch.size(); ++i) gains.push_back(scratch[i] - pretrained[i]);
  Json json = MeanOver(gains);
  const auto said = [&] {
    if (!json.contains("ci95")) return "one data set does not tell";
    if (json["ci95"][0].get<double>() > 0) return "pays";
    return json["ci95"][1].get<double>() < 0 ? "costs" : "no difference that these data sets tell";
  };
  json["verdict"] = said();
  return json;
}

/// The cells of a row of `plan.n_tuples[n]`, their keys after `prefix`.
void AddLearner(const std::string& prefix, const PretrainingScores::Learner& scores,
                const PretrainingPlan& plan, std::size_t n, Json* row) {
  (*row)[prefix + "scratch"] = MeanOver(scores.scratch[n]);
  for (std::size_t s = 0; s < plan.sources.size(); ++s) {
    // A row's preset is its base's description (BaseOf).
    const std::string& preset = plan.sources[s].description;
    (*row)[prefix + "pretrained_" + preset] = MeanOver(scores.pretrained[s][n]);
    (*row)[prefix + "gain_" + preset] = GainOver(scores.scratch[n], scores.pretrained[s][n]);
  }
}

}  // namespace

void AddLearnedAudits(const PcmRecipe& recipe, const ReproduceOptions& options, Json* audits) {
  const auto base = [&](const Overrides& overrides) {
    return Base("uavde_12mm", overrides, options.scenarios);
  };
  const auto draw = [&](const Overrides& overrides) {
    return DrawTuples(base(overrides), 1, options.threads);
  };
  Json findings = Json::array();
  for (const AuditFinding& found : Audit(base({}).rig.calibrated.ToStereoRig(), recipe, draw)) {
    findings.push_back({{"question", found.question},
                        {"baseline", found.baseline},
                        {"offset1", found.offset1},
                        {"pcm", found.pcm},
                        {"verdict", found.verdict}});
  }
  (*audits)["learned"] = std::move(findings);
}

PretrainingPlan PretrainingOf(Effort effort, const std::filesystem::path& scenarios) {
  PretrainingPlan plan;
  // Its flights are as many rigs.
  const Overrides rigs = {effort == Effort::kQuick ? "dataset.splits.train.flights=48"
                                                   : "dataset.splits.train.flights=96"};
  plan.sources = {Base("pretrain", rigs, scenarios), Base("uavde_12mm", {}, scenarios)};
  plan.unseen = Base("uavde_12mm", kUnseen, scenarios);
  if (effort == Effort::kQuick) {
    plan.recipe.epochs /= 3;
    plan.joint_mlp.epochs /= 3;
  } else {
    plan.n_tuples = {0, 20, 50, 100, 200, 500, 1000, 2000};
  }
  return plan;
}

Json ReproducePretraining(PretrainingPlan plan, const ReproduceOptions& options) {
  plan.n_seeds = options.n_seeds;
  plan.n_training_seeds = options.n_training_seeds;
  plan.threads = options.threads;
  int done = 0;
  const int total = plan.n_seeds * plan.n_training_seeds;
  const PretrainingScores scores = TryPretraining(plan, [&] {
    if (options.on_step) options.on_step(++done, total);
  });
  Json rows = Json::array();
  for (std::size_t n = 0; n < plan.n_tuples.size(); ++n) {
    Json row = {{"method", fmt::format("{} tuples", plan.n_tuples[n])},
                {"n_tuples", plan.n_tuples[n]}};
    AddLearner("", scores.pcm, plan, n, &row);
    row["offset1"] = MeanOver(scores.offset1[n]);
    AddLearner("joint_mlp_", scores.joint_mlp, plan, n, &row);
    rows.push_back(std::move(row));
  }
  return {{"table", "pretraining"},
          {"meaning",
           "Abs Rel behind a rig that was not learned on, by how many of its tuples are had: pcm "
           "and the joint network fine-tuned after pre-training, from scratch, and one offset. Not "
           "of the paper; 95 % "
           "intervals are Student's t over data sets."},
          {"unseen", kUnseen},
          {"seeds", plan.n_seeds},
          {"training_seeds", plan.n_training_seeds},
          {"rows", rows}};
}

}  // namespace windhover
