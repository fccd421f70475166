#include "learn/train_pcm.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "common/random/random_stream.h"
#include "estimator/mixer_pass.h"
#include "learn/mixer_kernel.h"

namespace windhover {
namespace {

constexpr int kPairs = MixerKernel::kBoxes / 2;
constexpr float kHuber = 0.1f;  // Of log d: gross detections pull no harder than this.

std::vector<float> InitialParameters(int width, int n_outputs, bool zero_head,
                                     RandomStream* random) {
  const int hidden = width / 2, tokens = kBoxTokens, token_hidden = MixerLayout<4>::kTokenHidden;
  std::vector<float> p;
  // As torch's Linear starts: uniform within 1/sqrt(inputs).
  const auto linear = [&](int outputs, int inputs, double scale = 1) {
    const double bound = scale / std::sqrt(inputs);
    for (int i = 0; i < outputs * (inputs + 1); ++i) {
      p.push_back(static_cast<float>(random->Uniform(-bound, bound)));
    }
  };
  const auto norm = [&] {
    p.insert(p.end(), static_cast<std::size_t>(width), 1.0f);
    p.insert(p.end(), static_cast<std::size_t>(width), 0.0f);
  };
  linear(width, 1);
  for (int b = 0; b < MixerLayout<4>::kBlocks; ++b) {
    norm();
    linear(token_hidden, tokens);
    linear(tokens, token_hidden);
    norm();
    linear(hidden, width);
    linear(width, hidden);
  }
  norm();
  linear(n_outputs, width, zero_head ? 0 : 1);
  return p;
}

/// A mixer in training.
struct Learner {
  std::unique_ptr<MixerKernel> kernel;
  std::vector<float> parameters;
  Optimiser optimiser;
  std::vector<float> gradient;

  Learner(const PcmRecipe& recipe, int n_outputs, const std::string& name)
      : kernel(MakeMixerKernel(recipe.width, n_outputs)),
        optimiser(recipe.optimiser,
                  static_cast<std::size_t>(MixerParameters(recipe.width, n_outputs))) {
    RandomStream random(recipe.seed, name);
    parameters = InitialParameters(recipe.width, n_outputs, recipe.zero_head, &random);
  }
  bool Step(double rate) {
    kernel->TakeGradient(&gradient);
    return optimiser.Step(rate, gradient, &parameters);
  }
};

/// A sample on its way through the stages.
struct Active {
  CorrectableBoxes boxes;
  BoxTokens tokens[2];
  float label_m;
  bool is_hard = false;

  explicit Active(const PcmSample& sample) : boxes(sample.boxes), label_m(sample.label_m) {
    Retokenise();
  }
  void Retokenise() {
    for (int side = 0; side < 2; ++side) tokens[side] = TokensOf(boxes, side);
  }
};

/// Derivative of the loss by the disparity, and the relative error.
struct Slope {
  float by_disparity, relative_error;
};

Slope SlopeOf(PcmLoss loss, const CorrectableBoxes& boxes, float disparity, float label_m) {
  if (loss == PcmLoss::kSquared) {  // As the authors', of the distance of either sign's parallax.
    const float held = std::copysign(std::max(std::abs(disparity), 1e-9f), disparity);
    const float d_m = boxes.Range_m(std::abs(held)), error_m = d_m - label_m;
    return {2 * error_m * -d_m / held, std::abs(error_m) / label_m};
  }
  const float least = 2 / boxes.image_width_px;  // Below, the slope stays: back to parallax.
  const float held = std::max(disparity, least);
  const float ratio = boxes.Range_m(held) / label_m;
  return {-std::clamp(std::log(ratio), -kHuber, kHuber) / held, std::abs(ratio - 1)};
}

MixerKernel::Tokens TokensOfBlock(const std::vector<Active>& samples, std::size_t begin) {
  MixerKernel::Tokens x{};
  for (std::size_t i = 0; i < kPairs && begin + i < samples.size(); ++i) {
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t k = 0; k < kBoxTokens; ++k) {
        x[k][2 * i + side] = samples[begin + i].tokens[side][k];
      }
    }
  }
  return x;
}

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
      offsets_.emplace_back(recipe, 1, fmt::format("pcm/{}", s));
      if (s + 1 < recipe.n_stages) gates_.emplace_back(recipe, 2, fmt::format("gate/{}", s));
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
        std::erase_if(batch_, [](const Active& sample) { return !sample.is_hard; });
      }
      for (Active& sample : batch_) sample.Retokenise();
    }
    return true;
  }

  // Leaves corrected positions, and who is hard, in batch_.
  bool LearnOffsets(std::size_t s, double rate) {
    Learner& learner = offsets_[s];
    const float share = 1 / static_cast<float>(batch_.size());
    for (std::size_t begin = 0; begin < batch_.size(); begin += kPairs) {
      MixerKernel::Outputs out, slope{};
      learner.kernel->Forward(learner.parameters.data(), TokensOfBlock(batch_, begin), &out);
      for (std::size_t i = 0; i < kPairs && begin + i < batch_.size(); ++i) {
        Active& sample = batch_[begin + i];
        sample.boxes.x[0] += out[0][2 * i];
        sample.boxes.x[1] += out[0][2 * i + 1];
        const Slope found =
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
    Learner& learner = gates_[s];
    const float share = static_cast<float>(recipe_.lambda) / static_cast<float>(batch_.size());
    for (std::size_t begin = 0; begin < batch_.size(); begin += kPairs) {
      MixerKernel::Outputs out, slope{};
      learner.kernel->Forward(learner.parameters.data(), TokensOfBlock(before_, begin), &out);
      for (std::size_t i = 0; i < kPairs && begin + i < batch_.size(); ++i) {
        const std::size_t left = 2 * i, right = left + 1;
        // Cross entropy of the softmax over both cameras' mean logits.
        const float margin = (out[1][left] + out[1][right] - out[0][left] - out[0][right]) / 2;
        const float hard = 1 / (1 + std::exp(-margin));
        const float by_margin = (hard - (batch_[begin + i].is_hard ? 1.0f : 0.0f)) * share / 2;
        slope[0][left] = slope[0][right] = -by_margin;
        slope[1][left] = slope[1][right] = by_margin;
      }
      learner.kernel->Backward(learner.parameters.data(), slope);
    }
    return learner.Step(rate);
  }

  PcmStages Current() const {
    PcmStages stages;
    for (const Learner& one : offsets_)
      stages.offsets.emplace_back(recipe_.width, 1, one.parameters);
    for (const Learner& one : gates_) stages.gates.emplace_back(recipe_.width, 2, one.parameters);
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
  std::vector<Active> train_, batch_, before_;
  std::vector<PcmSample> val_;
  std::vector<Learner> offsets_, gates_;
  std::string fingerprint_;

  int epoch_ = 0;
  std::vector<PcmCurvePoint> curve_;
  PcmStages best_;
  std::vector<float> best_first_;
  double best_val_ = 1e9, best_first_val_ = 1e9;

  double error_sum_ = 0;  // Of the epoch.
  int n_hard_ = 0;
};

namespace {

using Json = nlohmann::json;

Json StateOf(const Learner& learner) {
  const Optimiser::Memory& memory = learner.optimiser.memory();
  return {learner.parameters, memory.first, memory.second, memory.steps};
}

std::vector<float> Restored(const Json& json, std::size_t size) {
  auto values = json.get<std::vector<float>>();
  if (values.size() != size) throw std::invalid_argument("wrong number of parameters");
  return values;
}

void RestoreLearner(const Json& json, Learner* learner) {
  const std::size_t n = learner->parameters.size();
  learner->parameters = Restored(json.at(0), n);
  Optimiser::Memory memory = learner->optimiser.memory();
  memory.first = Restored(json.at(1), n);
  memory.second = Restored(json.at(2), memory.second.size());
  memory.steps = json.at(3).get<int>();
  learner->optimiser.Restore(std::move(memory));
}

}  // namespace

std::string PcmTrainer::Impl::State() const {
  Json json = {{"fingerprint", fingerprint_},
               {"epoch", epoch_},
               {"best_first", best_first_},
               {"best_val", best_val_},
               {"best_first_val", best_first_val_}};
  for (const Learner& one : offsets_) json["offsets"].push_back(StateOf(one));
  for (const Learner& one : gates_) json["gates"].push_back(StateOf(one));
  for (const Mixer& one : best_.offsets) json["best_offsets"].push_back(one.parameters());
  for (const Mixer& one : best_.gates) json["best_gates"].push_back(one.parameters());
  for (const PcmCurvePoint& p : curve_) {
    json["curve"].push_back({p.epoch, p.train_abs_rel, p.val_first, p.val, p.hard_share});
  }
  const std::vector<std::uint8_t> bytes = Json::to_cbor(json);
  return {bytes.begin(), bytes.end()};
}

void PcmTrainer::Impl::Restore(const std::string& state, const std::string& name) try {
  const Json json = Json::from_cbor(state);
  if (json.at("fingerprint") != fingerprint_) {
    throw std::invalid_argument("samples or recipe are others");
  }
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    RestoreLearner(json.at("offsets").at(i), &offsets_[i]);
    const auto n = offsets_[i].parameters.size();
    best_.offsets[i] = {recipe_.width, 1, Restored(json.at("best_offsets").at(i), n)};
  }
  for (std::size_t i = 0; i < gates_.size(); ++i) {
    RestoreLearner(json.at("gates").at(i), &gates_[i]);
    const auto n = gates_[i].parameters.size();
    best_.gates[i] = {recipe_.width, 2, Restored(json.at("best_gates").at(i), n)};
  }
  best_first_ = Restored(json.at("best_first"), offsets_[0].parameters.size());
  best_val_ = json.at("best_val").get<double>();
  best_first_val_ = json.at("best_first_val").get<double>();
  curve_.clear();
  for (const Json& p : json.value("curve", Json::array())) {
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

PcmScore Score(std::span<const RangedSample> samples) {
  PcmScore score;
  int n_near = 0;
  for (const RangedSample& sample : samples) {
    const bool is_range = std::isfinite(sample.range_m) && sample.range_m > 0;
    const double relative = is_range ? std::abs(sample.range_m / sample.label_m - 1.0) : 1.0;
    score.abs_rel += relative;
    score.sq_rel += relative * relative * sample.label_m;
    score.rms_rel += relative * relative;
    score.n_stages += sample.n_stages;
    (sample.label_m < 20 ? score.lt20 : score.gt20) += relative;
    n_near += sample.label_m < 20;
  }
  const auto n = std::max(1.0, static_cast<double>(samples.size()));
  score.abs_rel /= n;
  score.sq_rel /= n;
  score.rms_rel = std::sqrt(score.rms_rel / n);
  score.n_stages /= n;
  score.lt20 /= std::max(1, n_near);
  score.gt20 /= std::max(1.0, n - n_near);
  return score;
}

PcmScore ScorePcm(const PcmStages& stages, FurtherStages further,
                  std::span<const PcmSample> samples) {
  std::vector<RangedSample> ranged;
  for (const PcmSample& sample : samples) {
    const Correction corrected = Correct(stages, sample.boxes, further);
    ranged.push_back(
        {sample.boxes.Range_m(corrected.boxes.Disparity()), sample.label_m, corrected.n_stages});
  }
  return Score(ranged);
}

}  // namespace windhover
