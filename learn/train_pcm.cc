#include "learn/train_pcm.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "common/random/random_stream.h"
#include "learn/mixer_learner.h"
#include "learn/pcm_batch.h"
#include "learn/pcm_loss.h"

namespace windhover {
namespace {

std::uint64_t HashOf(const std::vector<PcmSample>& samples) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a, 64 bit
  static_assert(sizeof(PcmSample) == 12 * sizeof(float), "has no padding to hash");
  const auto* bytes = reinterpret_cast<const unsigned char*>(samples.data());
  for (std::size_t i = 0; i < samples.size() * sizeof(PcmSample); ++i) {
    hash = (hash ^ bytes[i]) * 1099511628211ULL;
  }
  return hash;
}

}  // namespace

PcmRecipe PaperRecipe() { return {}; }

PcmRecipe StableRecipe() {
  PcmRecipe recipe;
  recipe.epochs = 300;
  recipe.loss = PcmLoss::kLog;
  recipe.optimiser = {.kind = OptimiserKind::kAdamW,
                      .rate = 4e-3,
                      .momentum = 0.9,
                      .weight_decay = 1e-3,
                      .clip = 1};
  recipe.zero_head = true;
  recipe.validate_every = 5;
  return recipe;
}

class PcmTrainer::Impl {
 public:
  Impl(std::vector<PcmSample> train, std::vector<PcmSample> val, const PcmRecipe& recipe,
       const std::optional<PcmStages>& start)
      : recipe_(recipe), val_(std::move(val)) {
    if (train.empty() || val_.empty()) throw std::invalid_argument("a split has no samples");
    fingerprint_ =
        fmt::format("{:016x}{:016x} width {} stages {} epochs {} seed {}", HashOf(train),
                    HashOf(val_), recipe.width, recipe.n_stages, recipe.epochs, recipe.seed);
    for (const PcmSample& sample : train) train_.emplace_back(sample);
    for (int s = 0; s < recipe.n_stages; ++s) {
      offsets_.push_back(MakeLearner(1, fmt::format("pcm/{}", s)));
      if (s + 1 < recipe.n_stages) gates_.push_back(MakeLearner(2, fmt::format("gate/{}", s)));
    }
    if (start) StartFrom(*start);
    best_ = Current();
    best_first_ = start && start->alone ? start->alone->parameters() : offsets_[0].parameters;
  }

  bool Advance() {
    const int warm_up = std::max(1, static_cast<int>(recipe_.warm_up * recipe_.epochs));
    const double rate = recipe_.optimiser.rate * RateShare(epoch_, recipe_.epochs, warm_up);
    const std::vector<std::size_t> order = Shuffled();
    error_sum_ = 0;
    n_hard_ = 0;
    const auto batch = static_cast<std::size_t>(recipe_.batch);
    for (std::size_t begin = 0; begin < order.size(); begin += batch) {
      batch_.clear();
      for (std::size_t i = begin; i < std::min(begin + batch, order.size()); ++i) {
        batch_.push_back(train_[order[i]]);
      }
      if (!LearnBatch(rate)) return false;
    }
    ++epoch_;
    if (epoch_ % recipe_.validate_every == 0 || epoch_ == recipe_.epochs) Validate();
    return true;
  }

  PcmStages Best() const {
    PcmStages best = best_;
    best.alone.emplace(recipe_.width, 1, best_first_);
    const FurtherStages modes[] = {FurtherStages::kNone, FurtherStages::kByGate,
                                   FurtherStages::kForAll};
    for (std::size_t i = 0; i < 3; ++i) {
      best.range_sigma[i] = std::min(ScorePcm(best, modes[i], val_).rms_rel, 9.0);
    }
    return best;
  }

  std::string State() const;
  void Restore(const std::string& state, const std::string& name);

  int epoch() const { return epoch_; }
  const PcmRecipe& recipe() const { return recipe_; }
  const std::vector<PcmCurvePoint>& curve() const { return curve_; }

 private:
  MixerLearner MakeLearner(int n_outputs, const std::string& name) const {
    return {recipe_.width, n_outputs, recipe_.optimiser, recipe_.zero_head, recipe_.seed, name};
  }

  void StartFrom(const PcmStages& start) {
    const bool fits =
        start.offsets.size() == offsets_.size() && start.offsets.front().width() == recipe_.width;
    if (!fits) {
      throw std::invalid_argument(fmt::format(
          "it has {} stages of width {}, the recipe {} of width {}", start.offsets.size(),
          start.offsets.front().width(), recipe_.n_stages, recipe_.width));
    }
    for (std::size_t s = 0; s < offsets_.size(); ++s) {
      offsets_[s].parameters = start.offsets[s].parameters();
      if (s < gates_.size()) gates_[s].parameters = start.gates[s].parameters();
    }
  }

  // A function of seed and epoch alone, so that training can go on from any epoch.
  std::vector<std::size_t> Shuffled() const {
    RandomStream random(recipe_.seed, fmt::format("shuffle/{}", epoch_));
    std::vector<std::size_t> order(train_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      std::swap(order[i], order[random() % (i + 1)]);
    }
    return order;
  }

  bool LearnBatch(double rate) {
    for (std::size_t s = 0; s < offsets_.size() && !batch_.empty(); ++s) {
      before_ = batch_;
      if (!LearnOffsets(s, rate)) return false;
      if (s + 1 == offsets_.size()) return true;
      if (!recipe_.all_hard) {
        if (!LearnGate(s, rate)) return false;
        std::erase_if(batch_, [](const ActiveSample& sample) { return !sample.is_hard; });
      }
      for (ActiveSample& sample : batch_) sample.Retokenise();
    }
    return true;
  }

  // Leaves corrected positions, and who is hard, in batch_.
  bool LearnOffsets(std::size_t s, double rate) {
    MixerLearner& learner = offsets_[s];
    const float share = 1 / static_cast<float>(batch_.size());
    for (std::size_t begin = 0; begin < batch_.size(); begin += kPairs) {
      MixerKernel::Outputs out, slope{};
      learner.kernel->Forward(learner.parameters.data(), TokensOfBlock(batch_, begin), &out);
      for (std::size_t i = 0; i < kPairs && begin + i < batch_.size(); ++i) {
        ActiveSample& sample = batch_[begin + i];
        sample.boxes.x[0] += out[0][2 * i];
        sample.boxes.x[1] += out[0][2 * i + 1];
        const LossSlope found =
            SlopeOf(recipe_.loss, sample.boxes, sample.boxes.Disparity(), sample.label_m);
        slope[0][2 * i] = found.by_disparity * share;
        slope[0][2 * i + 1] = -found.by_disparity * share;
        sample.is_hard = !(found.relative_error <= recipe_.threshold);
        if (s > 0) continue;
        error_sum_ += found.relative_error;
        n_hard_ += sample.is_hard;
      }
      learner.kernel->Backward(learner.parameters.data(), slope);
    }
    return learner.Step(rate);
  }

  // The gate sees what the module saw: the 4-tuples of before_.
  bool LearnGate(std::size_t s, double rate) {
    MixerLearner& learner = gates_[s];
    const float share = static_cast<float>(recipe_.lambda) / static_cast<float>(batch_.size());
    for (std::size_t begin = 0; begin < batch_.size(); begin += kPairs) {
      MixerKernel::Outputs out, slope{};
      learner.kernel->Forward(learner.parameters.data(), TokensOfBlock(before_, begin), &out);
      for (std::size_t i = 0; i < kPairs && begin + i < batch_.size(); ++i) {
        const std::size_t left = 2 * i, right = left + 1;
        // Cross entropy of the softmax over both cameras' mean logits.
        const float margin = (out[1][left] + out[1][right] - out[0][left] - out[0][right]) / 2;
        const float by_margin = GateSlopeOf(margin, batch_[begin + i].is_hard) * share / 2;
        slope[0][left] = slope[0][right] = -by_margin;
        slope[1][left] = slope[1][right] = by_margin;
      }
      learner.kernel->Backward(learner.parameters.data(), slope);
    }
    return learner.Step(rate);
  }

  PcmStages Current() const {
    PcmStages stages;
    for (const MixerLearner& one : offsets_)
      stages.offsets.emplace_back(recipe_.width, 1, one.parameters);
    for (const MixerLearner& one : gates_)
      stages.gates.emplace_back(recipe_.width, 2, one.parameters);
    return stages;
  }

  void Validate() {
    const PcmStages now = Current();
    const auto n = static_cast<double>(train_.size());
    const double first = ScorePcm(now, FurtherStages::kNone, val_).abs_rel;
    const auto further = recipe_.all_hard ? FurtherStages::kForAll : FurtherStages::kByGate;
    const double all = offsets_.size() == 1 ? first : ScorePcm(now, further, val_).abs_rel;
    curve_.push_back({epoch_, error_sum_ / n, first, all, n_hard_ / n});
    if (first < best_first_val_) {
      best_first_val_ = first;
      best_first_ = offsets_[0].parameters;
    }
    if (all < best_val_) {
      best_val_ = all;
      best_ = now;
    }
  }

  PcmRecipe recipe_;
  std::vector<ActiveSample> train_, batch_, before_;
  std::vector<PcmSample> val_;
  std::vector<MixerLearner> offsets_, gates_;
  std::string fingerprint_;

  int epoch_ = 0;
  std::vector<PcmCurvePoint> curve_;
  PcmStages best_;
  std::vector<float> best_first_;
  double best_val_ = 1e9, best_first_val_ = 1e9;

  double error_sum_ = 0;  // Of the epoch.
  int n_hard_ = 0;
};

std::string PcmTrainer::Impl::State() const {
  nlohmann::json json = {{"fingerprint", fingerprint_},
                         {"epoch", epoch_},
                         {"best_first", best_first_},
                         {"best_val", best_val_},
                         {"best_first_val", best_first_val_}};
  for (const MixerLearner& one : offsets_) json["offsets"].push_back(one.State());
  for (const MixerLearner& one : gates_) json["gates"].push_back(one.State());
  for (const Mixer& one : best_.offsets) json["best_offsets"].push_back(one.parameters());
  for (const Mixer& one : best_.gates) json["best_gates"].push_back(one.parameters());
  for (const PcmCurvePoint& p : curve_) {
    json["curve"].push_back({p.epoch, p.train_abs_rel, p.val_first, p.val, p.hard_share});
  }
  const std::vector<std::uint8_t> bytes = nlohmann::json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

void PcmTrainer::Impl::Restore(const std::string& state, const std::string& name) try {
  const nlohmann::json json = nlohmann::json::from_cbor(state);
  if (json.at("fingerprint") != fingerprint_) {
    throw std::invalid_argument("samples or recipe are others");
  }
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    offsets_[i].Restore(json.at("offsets").at(i));
    const auto n = offsets_[i].parameters.size();
    best_.offsets[i] = {recipe_.width, 1, NumbersFrom(json.at("best_offsets").at(i), n)};
  }
  for (std::size_t i = 0; i < gates_.size(); ++i) {
    gates_[i].Restore(json.at("gates").at(i));
    const auto n = gates_[i].parameters.size();
    best_.gates[i] = {recipe_.width, 2, NumbersFrom(json.at("best_gates").at(i), n)};
  }
  best_first_ = NumbersFrom(json.at("best_first"), offsets_[0].parameters.size());
  best_val_ = json.at("best_val").get<double>();
  best_first_val_ = json.at("best_first_val").get<double>();
  curve_.clear();
  for (const nlohmann::json& p : json.value("curve", nlohmann::json::array())) {
    curve_.push_back({p.at(0), p.at(1), p.at(2), p.at(3), p.at(4)});
  }
  epoch_ = json.at("epoch").get<int>();
} catch (const std::exception& error) {
  throw ConfigError(fmt::format("{}: must be the state of this training ({})", name, error.what()));
}

PcmTrainer::PcmTrainer(std::vector<PcmSample> train, std::vector<PcmSample> val,
                       const PcmRecipe& recipe, const std::optional<PcmStages>& start)
    : impl_(std::make_unique<Impl>(std::move(train), std::move(val), recipe, start)) {}
PcmTrainer::PcmTrainer(PcmTrainer&& other) noexcept = default;
PcmTrainer::~PcmTrainer() = default;
bool PcmTrainer::Advance() { return impl_->Advance(); }
void PcmTrainer::Finish() {
  while (!finished() && Advance()) {
  }
}
int PcmTrainer::epochs_done() const { return impl_->epoch(); }
bool PcmTrainer::finished() const { return impl_->epoch() >= impl_->recipe().epochs; }
const std::vector<PcmCurvePoint>& PcmTrainer::curve() const { return impl_->curve(); }
PcmStages PcmTrainer::Best() const { return impl_->Best(); }
std::string PcmTrainer::State() const { return impl_->State(); }
void PcmTrainer::Restore(const std::string& state, const std::string& name) {
  impl_->Restore(state, name);
}

}  // namespace windhover
