#include "learn/detector/detector_trainer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <future>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "learn/detector/torch_network.h"
#include "learn/optimiser.h"

namespace windhover {
namespace {

using Json = nlohmann::json;

Json BinaryOf(const std::vector<float>& values) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(values.data());
  return Json::binary({bytes, bytes + values.size() * sizeof(float)});
}

std::vector<float> FloatsOf(const Json& json, std::size_t size) {
  const std::vector<std::uint8_t>& bytes = json.get_binary();
  if (bytes.size() != size * sizeof(float)) throw std::invalid_argument("another network");
  std::vector<float> values(size);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
    throw std::invalid_argument("numbers that are not finite");
  }
  return values;
}

/// a := share a + (1 - share) b.
void Blend(double share, const std::vector<float>& b, std::vector<float>* a) {
  const auto keep = static_cast<float>(share), take = static_cast<float>(1 - share);
  for (std::size_t i = 0; i < b.size(); ++i) (*a)[i] = keep * (*a)[i] + take * b[i];
}

LearnedNetwork Unfolded(const LayerTable& table, const NetworkWeights& weights) {
  CheckWeights(table, weights);
  LearnedNetwork network;
  for (const ConvWeights& own : weights.layers) {
    auto& p = network.parameters;
    p.insert(p.end(), own.weight.begin(), own.weight.end());
    p.insert(p.end(), own.bias.begin(), own.bias.end());
  }
  return network;
}

YoloxNetwork NetworkOf(const DetectorRecipe& recipe, bool has_start) {
  YoloxNetwork network = MakeYolox(recipe.network);
  return has_start ? WithoutNorm(std::move(network)) : network;
}

}  // namespace

nlohmann::ordered_json ToJson(const DetectorRecipe& recipe) {
  return {{"network", recipe.network}, {"steps", recipe.steps},
          {"optimiser", "AdamW"},      {"rate", recipe.rate},
          {"warm_up", recipe.warm_up}, {"weight_decay", recipe.weight_decay},
          {"clip", recipe.clip},       {"average_decay", recipe.average_decay},
          {"seed", recipe.seed}};
}

YoloxNetwork WithoutNorm(YoloxNetwork network) {
  for (Layer& layer : network.table.layers) layer.batch_norm = false;
  return network;
}

class DetectorTrainer::Impl {
 public:
  Impl(const DetectorRecipe& recipe, int threads, const std::optional<NetworkWeights>& start)
      : recipe_(recipe),
        threads_(threads),
        network_(NetworkOf(recipe, start.has_value())),
        now_(start ? Unfolded(network_.table, *start)
                   : InitialNetwork(network_.table, recipe.seed)),
        average_(now_),
        optimiser_({.kind = OptimiserKind::kAdamW,
                    .rate = recipe.rate,
                    .weight_decay = recipe.weight_decay,
                    .clip = recipe.clip},
                   now_.parameters.size()),
        halves_{Half(network_), Half(network_)} {}

  std::optional<YoloxLossParts> Step(std::span<const DetectorSample> batch) {
    return Follow(LearnHalves(batch, now_));
  }

  void Settle(std::span<const DetectorSample> batch) {
    if (average_.statistics.empty()) return;
    LearnHalves(batch, average_);
    average_.statistics = halves_[0].learned.statistics;
  }

  NetworkWeights Average() const { return Folded(network_.table, average_); }

  Json State() const {
    const Optimiser::Memory& memory = optimiser_.memory();
    return {{"step", step_},
            {"parameters", BinaryOf(now_.parameters)},
            {"statistics", BinaryOf(now_.statistics)},
            {"average_parameters", BinaryOf(average_.parameters)},
            {"average_statistics", BinaryOf(average_.statistics)},
            {"first_moments", BinaryOf(memory.first)},
            {"second_moments", BinaryOf(memory.second)}};
  }

  void Restore(const Json& state) {
    const std::size_t n = now_.parameters.size(), n_statistics = now_.statistics.size();
    const int step = state.at("step").get<int>();
    if (step < 0 || step > recipe_.steps) throw std::invalid_argument("another number of steps");
    LearnedNetwork now = {FloatsOf(state.at("parameters"), n),
                          FloatsOf(state.at("statistics"), n_statistics)};
    LearnedNetwork average = {FloatsOf(state.at("average_parameters"), n),
                              FloatsOf(state.at("average_statistics"), n_statistics)};
    optimiser_.Restore(
        {FloatsOf(state.at("first_moments"), n), FloatsOf(state.at("second_moments"), n), step});
    now_ = std::move(now);
    average_ = std::move(average);
    step_ = step;
  }

  int steps_done() const { return step_; }
  const YoloxNetwork& network() const { return network_; }

 private:
  /// A thread's share of a step.
  struct Half {
    explicit Half(const YoloxNetwork& network) : torch(std::make_unique<TorchNetwork>(network)) {}

    void Learn(std::span<const DetectorSample> batch, const LearnedNetwork& now) {
      learned = now;
      loss = torch->Gradient(batch, &learned, &gradient);
    }

    std::unique_ptr<TorchNetwork> torch;
    LearnedNetwork learned;
    std::vector<float> gradient;
    YoloxLossParts loss;
  };

  /// Gradient, loss and statistics of `network` for a batch: those of its halves joined in the
  /// first.
  const YoloxLossParts& LearnHalves(std::span<const DetectorSample> batch,
                                    const LearnedNetwork& network) {
    const std::size_t middle = (batch.size() + 1) / 2;
    const auto launch = threads_ > 1 ? std::launch::async : std::launch::deferred;
    auto second = std::async(launch, [&] {
      if (batch.size() > 1) halves_[1].Learn(batch.subspan(middle), network);
    });
    halves_[0].Learn(batch.first(middle), network);
    second.get();
    YoloxLossParts& loss = halves_[0].loss;
    if (batch.size() == 1) return loss;
    const YoloxLossParts& other = halves_[1].loss;
    loss.box = (loss.box + other.box) / 2;
    loss.offset = (loss.offset + other.offset) / 2;
    loss.objectness = (loss.objectness + other.objectness) / 2;
    loss.cls = (loss.cls + other.cls) / 2;
    loss.n_assigned += other.n_assigned;
    Blend(0.5, halves_[1].gradient, &halves_[0].gradient);
    Blend(0.5, halves_[1].learned.statistics, &halves_[0].learned.statistics);
    return loss;
  }

  std::optional<YoloxLossParts> Follow(const YoloxLossParts& loss) {
    const int warm_up = std::max(1, static_cast<int>(recipe_.warm_up * recipe_.steps));
    const double rate = recipe_.rate * RateShare(step_, recipe_.steps, warm_up);
    if (!optimiser_.Step(rate, halves_[0].gradient, &now_.parameters)) return std::nullopt;
    now_.statistics = halves_[0].learned.statistics;
    ++step_;
    const double decay = std::min(recipe_.average_decay, (1.0 + step_) / (10.0 + step_));
    Blend(decay, now_.parameters, &average_.parameters);
    Blend(decay, now_.statistics, &average_.statistics);
    return loss;
  }

  DetectorRecipe recipe_;
  int threads_;
  YoloxNetwork network_;
  LearnedNetwork now_, average_;
  Optimiser optimiser_;
  std::array<Half, 2> halves_;
  int step_ = 0;
};

DetectorTrainer::DetectorTrainer(const DetectorRecipe& recipe, int threads,
                                 const std::optional<NetworkWeights>& start)
    : impl_(std::make_unique<Impl>(recipe, threads, start)) {}
DetectorTrainer::~DetectorTrainer() = default;
std::optional<YoloxLossParts> DetectorTrainer::Step(const std::vector<DetectorSample>& batch) {
  return impl_->Step(batch);
}
void DetectorTrainer::Settle(const std::vector<DetectorSample>& batch) { impl_->Settle(batch); }
int DetectorTrainer::steps_done() const { return impl_->steps_done(); }
const YoloxNetwork& DetectorTrainer::network() const { return impl_->network(); }
NetworkWeights DetectorTrainer::Average() const { return impl_->Average(); }
nlohmann::json DetectorTrainer::State() const { return impl_->State(); }
void DetectorTrainer::Restore(const nlohmann::json& state) { impl_->Restore(state); }

}  // namespace windhover
