#include "learn/detector/train_detector.h"

#include <algorithm>
#include <fstream>
#include <future>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "common/file/whole_file.h"
#include "eval/svg_chart.h"

namespace windhover {
namespace {

using Json = nlohmann::json;

constexpr int kCurvePoints = 200;

/// The next batch is made while this one is learned.
class BatchesAhead {
 public:
  BatchesAhead(DetectorSampleSource* source, int step) : source_(*source), step_(step) { Start(); }

  std::vector<DetectorSample> Take() {
    std::vector<DetectorSample> batch = next_.get();
    ++step_;
    Start();
    return batch;
  }

 private:
  void Start() {
    next_ = std::async(std::launch::async,
                       [&source = source_, step = step_] { return source.Batch(step); });
  }

  DetectorSampleSource& source_;
  int step_;
  std::future<std::vector<DetectorSample>> next_;
};

/// A training between two steps.
struct Training {
  explicit Training(const DetectorPlan& training_plan)
      : plan(training_plan), trainer(plan.recipe, plan.threads, plan.start) {}

  Json Identity() const {
    Json identity = {{"recipe", ToJson(plan.recipe)}, {"data", plan.data}};
    identity["tuned"] = plan.start.has_value();
    return identity;
  }

  void Save() const {
    Json state = {{"training", Identity()},
                  {"trainer", trainer.State()},
                  {"sums", {loss_sum, box_sum, n_summed}},
                  {"curve", Json::array()}};
    for (const DetectorCurvePoint& p : curve) state["curve"].push_back({p.step, p.loss, p.box});
    const std::vector<std::uint8_t> bytes = Json::to_cbor(state);
    ReplaceFile(plan.state_file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }

  void Restore() try {
    std::ifstream in(plan.state_file, std::ios::binary);
    if (!in) throw std::invalid_argument("it is not there");
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const Json state = Json::from_cbor(bytes);
    if (state.at("training") != Identity())
      throw std::invalid_argument("data or recipe are others");
    trainer.Restore(state.at("trainer"));
    loss_sum = state.at("sums").at(0);
    box_sum = state.at("sums").at(1);
    n_summed = state.at("sums").at(2);
    for (const Json& p : state.at("curve")) curve.push_back({p.at(0), p.at(1), p.at(2)});
  } catch (const std::exception& error) {
    throw ConfigError(fmt::format("{}: must be the state of this training ({})",
                                  plan.state_file.string(), error.what()));
  }

  void Note(const YoloxLossParts& loss) {
    loss_sum += loss.Total();
    box_sum += loss.box;
    ++n_summed;
    const int every = std::max(1, plan.recipe.steps / kCurvePoints);
    if (trainer.steps_done() % every != 0) return;
    curve.push_back({trainer.steps_done(), loss_sum / n_summed, box_sum / n_summed});
    loss_sum = box_sum = 0;
    n_summed = 0;
  }

  const DetectorPlan& plan;
  DetectorTrainer trainer;
  std::vector<DetectorCurvePoint> curve;
  double loss_sum = 0, box_sum = 0;
  int n_summed = 0;
};

DetectorTrainingEnd Run(Training* training,
                        const std::function<bool(int done, int total)>& on_step) {
  DetectorTrainer& trainer = training->trainer;
  const int total = training->plan.recipe.steps;
  const int settling = training->plan.settling_steps;
  if (trainer.steps_done() >= total && settling == 0) return DetectorTrainingEnd::kFinished;
  const std::unique_ptr<DetectorSampleSource> source = training->plan.make_source();
  BatchesAhead batches(source.get(), trainer.steps_done());
  while (trainer.steps_done() < total) {
    const auto loss = trainer.Step(batches.Take());
    if (!loss) return DetectorTrainingEnd::kDiverged;
    training->Note(*loss);
    const int done = trainer.steps_done();
    const bool go_on = on_step(done, total);
    if (done == total || !go_on || done % training->plan.save_every == 0) training->Save();
    if (!go_on && done < total) return DetectorTrainingEnd::kInterrupted;
  }
  for (int i = 0; i < settling; ++i) trainer.Settle(batches.Take());
  return DetectorTrainingEnd::kFinished;
}

}  // namespace

TrainedDetector TrainDetector(const DetectorPlan& plan,
                              const std::function<bool(int done, int total)>& on_step) {
  Training training(plan);
  if (plan.resume) training.Restore();
  TrainedDetector trained;
  trained.end = Run(&training, on_step);
  trained.weights = training.trainer.Average();
  trained.steps_done = training.trainer.steps_done();
  trained.curve = std::move(training.curve);
  return trained;
}

std::string DetectorCurveSvg(const std::vector<DetectorCurvePoint>& curve) {
  Chart chart{.title = "Loss while learning", .x_label = "step", .y_label = "loss", .series = {}};
  const auto add = [&](const char* name, int look, double DetectorCurvePoint::*value) {
    ChartSeries series{.name = name, .look = look, .points = {}};
    for (const DetectorCurvePoint& p : curve) {
      series.points.push_back({static_cast<double>(p.step), p.*value});
    }
    chart.series.push_back(std::move(series));
  };
  add("all", 0, &DetectorCurvePoint::loss);
  add("box: 5 (1 - overlap²)", 1, &DetectorCurvePoint::box);
  chart.y_max = 12;
  return ChartFileSvg(chart);
}

}  // namespace windhover
