#include "learn/train_card.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "common/file/whole_file.h"
#include "eval/svg_chart.h"
#include "learn/fit_priors.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

double Rounded(double value) { return std::stod(fmt::format("{:.5g}", value)); }

Json ScoreJson(const PcmScore& score) {
  return {{"abs_rel", Rounded(score.abs_rel)},
          {"sq_rel", Rounded(score.sq_rel)},
          {"lt20", Rounded(score.lt20)},
          {"gt20", Rounded(score.gt20)},
          {"n_stages", Rounded(score.n_stages)}};
}

Json ScoresJson(const CorrectionCard& card, std::span<const PcmSample> samples) {
  Json json;
  std::vector<RangedSample> baseline;
  for (const PcmSample& sample : samples) {
    baseline.push_back({sample.boxes.Range_m(sample.boxes.Disparity()), sample.label_m, 0});
  }
  json["baseline"] = ScoreJson(Score(baseline));
  json["pcm"] = ScoreJson(ScorePcm(*card.pcm, FurtherStages::kNone, samples));
  if (card.pcm->offsets.size() > 1) {
    json["pcm_dic"] = ScoreJson(ScorePcm(*card.pcm, FurtherStages::kByGate, samples));
    json["pcm_dic_star"] = ScoreJson(ScorePcm(*card.pcm, FurtherStages::kForAll, samples));
  }
  if (card.joint_mlp) json["joint_mlp"] = ScoreJson(ScoreJointMlp(*card.joint_mlp, samples));
  return json;
}

Json RecipeJson(const PcmRecipe& recipe) {
  const bool is_sgd = recipe.optimiser.kind == OptimiserKind::kSgd;
  return {{"loss", recipe.loss == PcmLoss::kSquared ? "squared metres" : "Huber of log distance"},
          {"optimiser", is_sgd ? "SGD" : "AdamW"},
          {"rate", recipe.optimiser.rate},
          {"momentum", recipe.optimiser.momentum},
          {"weight_decay", recipe.optimiser.weight_decay},
          {"clip", recipe.optimiser.clip},
          {"epochs", recipe.epochs},
          {"warm_up", recipe.warm_up},
          {"batch", recipe.batch},
          {"stages", recipe.n_stages},
          {"width", recipe.width},
          {"threshold", recipe.threshold},
          {"lambda", recipe.lambda},
          {"all_hard", recipe.all_hard},
          {"zero_head", recipe.zero_head},
          {"seed", recipe.seed}};
}

std::string ReadState(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    throw ConfigError(fmt::format("{}: must be the state of an interrupted training (found none)",
                                  file.string()));
  }
  return {std::istreambuf_iterator<char>(in), {}};
}

PcmTrainer MakeTrainer(const CardPlan& plan, const std::vector<PcmSample>& train,
                       const std::vector<PcmSample>& val) try {
  const auto start = plan.start ? plan.start->pcm : std::nullopt;
  return PcmTrainer(train, val, plan.pcm, start);
} catch (const std::invalid_argument& error) {
  throw ConfigError(fmt::format("training cannot start: {}", error.what()));
}

/// Nothing where there are too few flights to tell what differs between them.
std::optional<FittedPriors> PriorsOf(const CardPlan& plan) try {
  return FitPriors(plan.tuples.train, plan.rig);
} catch (const std::invalid_argument&) {
  return plan.start ? plan.start->priors : std::nullopt;
}

}  // namespace

std::vector<PcmSample> SamplesOf(std::span<const StereoTuple> tuples, const StereoRig& rig) {
  std::vector<PcmSample> samples;
  for (const StereoTuple& tuple : tuples) {
    if (const auto boxes = MakeCorrectable(rig, tuple.box)) {
      samples.push_back({*boxes, static_cast<float>(tuple.range_m)});
    }
  }
  return samples;
}

SampleSplits SamplesOf(const TupleSplits& tuples, const StereoRig& rig) {
  return {SamplesOf(tuples.train, rig), SamplesOf(tuples.val, rig), SamplesOf(tuples.test, rig)};
}

TrainedCard TrainCard(const CardPlan& plan,
                      const std::function<bool(int done, int total)>& on_epoch) {
  const auto [train, val, test] = SamplesOf(plan.tuples, plan.rig);
  PcmTrainer trainer = MakeTrainer(plan, train, val);
  if (plan.resume) trainer.Restore(ReadState(plan.state_file), plan.state_file.string());
  TrainedCard trained;
  while (!trainer.finished() && trained.end == TrainingEnd::kFinished) {
    if (!trainer.Advance()) {
      trained.end = TrainingEnd::kDiverged;
    } else if (!on_epoch(trainer.epochs_done(), plan.pcm.epochs) && !trainer.finished()) {
      trained.end = TrainingEnd::kInterrupted;
      ReplaceFile(plan.state_file, trainer.State());
      return trained;
    }
  }
  trained.card.pcm = trainer.Best();
  trained.curve = trainer.curve();
  trained.card.joint_mlp = TrainJointMlp(train, val, plan.joint_mlp);
  trained.card.priors = PriorsOf(plan);
  Json& provenance = trained.card.provenance;
  provenance = plan.provenance;
  provenance["recipe"] = RecipeJson(plan.pcm);
  if (trained.end == TrainingEnd::kDiverged) {
    provenance["diverged_after_epochs"] = trainer.epochs_done();
  }
  provenance["tuples"] = {
      {"train", train.size()}, {"val", val.size()}, {"test", plan.tuples.test.size()}};
  provenance["scores"] = {{"val", ScoresJson(trained.card, val)},
                          {"test", ScoresJson(trained.card, test)}};
  return trained;
}

std::string CurveSvg(const std::vector<PcmCurvePoint>& curve) {
  Chart chart{.title = "Abs Rel while learning",
              .x_label = "epoch",
              .y_label = "Abs Rel",
              .series = {},
              .y_max = 0.6};
  const auto add = [&](const char* name, int look, double PcmCurvePoint::*value) {
    ChartSeries series{.name = name, .look = look, .points = {}};
    const std::size_t step = 1 + curve.size() / 400;
    for (std::size_t i = 0; i < curve.size(); i += step) {
      series.points.push_back({static_cast<double>(curve[i].epoch), curve[i].*value});
    }
    chart.series.push_back(std::move(series));
  };
  add("first stage, train", 0, &PcmCurvePoint::train_abs_rel);
  add("first stage, val", 1, &PcmCurvePoint::val_first);
  add("all stages, val", 2, &PcmCurvePoint::val);
  return ChartFileSvg(chart);
}

std::string ScoresText(const CorrectionCard& card) {
  const Json& scores = card.provenance.at("scores");
  std::string text = fmt::format("{:14} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "val", "test",
                                 "Sq Rel", "< 20 m", "> 20 m");
  for (const auto& [method, test] : scores.at("test").items()) {
    const double val = scores.at("val").at(method).at("abs_rel").get<double>();
    const auto number = [&, &row = test](const char* key) { return row.at(key).get<double>(); };
    text += fmt::format("{:14} {:8.4f} {:8.4f} {:8.3f} {:8.4f} {:8.4f}\n", method, val,
                        number("abs_rel"), number("sq_rel"), number("lt20"), number("gt20"));
  }
  return text;
}

}  // namespace windhover
