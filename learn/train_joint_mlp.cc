#include "learn/train_joint_mlp.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/random/random_stream.h"
#include "learn/optimiser.h"

namespace windhover {
namespace {

using Eigen::MatrixXf;
using Eigen::VectorXf;
using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kInputs = JointMlp::kInputs, kHidden = JointMlp::kHidden;
constexpr float kHuber = 0.05f;

/// Where a layer stands among the parameters.
struct Layer {
  int at, outputs, inputs;
  Eigen::Map<const Weights> W(const float* p) const { return {p + at, outputs, inputs}; }
  Eigen::Map<const VectorXf> b(const float* p) const {
    return {p + at + outputs * inputs, outputs};
  }
  Eigen::Map<Weights> W(float* p) const { return {p + at, outputs, inputs}; }
  Eigen::Map<VectorXf> b(float* p) const { return {p + at + outputs * inputs, outputs}; }
};
constexpr Layer kFirst{0, kHidden, kInputs};
constexpr Layer kSecond{kHidden * (kInputs + 1), kHidden, kHidden};
constexpr Layer kLast{kHidden * (kInputs + 1) + kHidden * (kHidden + 1), 1, kHidden};

MatrixXf Sigmoid(const MatrixXf& x) { return (1 + (-x.array()).exp()).inverse(); }

void AddLayer(const Layer& layer, const MatrixXf& d_out, const MatrixXf& in, float* g) {
  layer.W(g).noalias() += d_out * in.transpose();
  layer.b(g) += d_out.rowwise().sum();
}

/// Through SiLU: x σ(x), whose derivative is σ + x σ (1 - σ).
struct Activated {
  MatrixXf x, sigma, y;
  explicit Activated(MatrixXf in) : x(std::move(in)), sigma(Sigmoid(x)), y(x.cwiseProduct(sigma)) {}
  MatrixXf Back(const MatrixXf& d) const {
    return d.array() * (sigma.array() + y.array() * (1 - sigma.array()));
  }
};

JointMlp::Parameters Initial(const MatrixXf& inputs, const VectorXf& log_m, RandomStream* random) {
  JointMlp::Parameters mlp;
  mlp.mean = inputs.rowwise().mean();
  mlp.scale = ((inputs.colwise() - inputs.rowwise().mean()).rowwise().norm() /
               std::sqrt(static_cast<float>(inputs.cols())))
                  .cwiseMax(1e-6f);
  mlp.mean_log_m = log_m.mean();
  for (const Layer& layer : {kFirst, kSecond, kLast}) {
    const double bound = 1 / std::sqrt(layer.inputs);
    for (int i = 0; i < layer.outputs * (layer.inputs + 1); ++i) {
      mlp.weights.push_back(static_cast<float>(random->Uniform(-bound, bound)));
    }
  }
  return mlp;
}

}  // namespace

float JointMlpLoss(const JointMlp& mlp, const MatrixXf& inputs, const VectorXf& log_m,
                   std::vector<float>* gradient) {
  const JointMlp::Parameters& p = mlp.parameters();
  const float* w = p.weights.data();
  const MatrixXf unit =
      (inputs.colwise() - VectorXf(p.mean)).array().colwise() / VectorXf(p.scale).array();
  const Activated first((kFirst.W(w) * unit).colwise() + VectorXf(kFirst.b(w)));
  const Activated second((kSecond.W(w) * first.y).colwise() + VectorXf(kSecond.b(w)));
  const Eigen::RowVectorXf error =
      ((kLast.W(w) * second.y).array() + kLast.b(w)[0] + p.mean_log_m).matrix() - log_m.transpose();
  const auto n = static_cast<float>(inputs.cols());
  const MatrixXf d_out = error.cwiseMax(-kHuber).cwiseMin(kHuber) / n;
  gradient->assign(p.weights.size(), 0);
  float* g = gradient->data();
  AddLayer(kLast, d_out, second.y, g);
  const MatrixXf d_second = second.Back(kLast.W(w).transpose() * d_out);
  AddLayer(kSecond, d_second, first.y, g);
  AddLayer(kFirst, first.Back(kSecond.W(w).transpose() * d_second), unit, g);
  return error
             .unaryExpr([](float e) {
               const float a = std::abs(e);
               return a < kHuber ? e * e / 2 : kHuber * (a - kHuber / 2);
             })
             .sum() /
         n;
}

JointMlp TrainJointMlp(std::span<const PcmSample> train, std::span<const PcmSample> val,
                       const JointMlpRecipe& recipe, const std::optional<JointMlp>& start) {
  const auto n = static_cast<Eigen::Index>(train.size());
  MatrixXf inputs(kInputs, n);
  VectorXf log_m(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const PcmSample& sample = train[static_cast<std::size_t>(i)];
    inputs.col(i) = JointMlp::InputsOf(sample.boxes);
    log_m[i] = std::log(sample.label_m);
  }
  RandomStream random(recipe.seed, "joint_mlp");
  JointMlp mlp = start ? *start : JointMlp(Initial(inputs, log_m, &random));
  Optimiser optimiser({.kind = OptimiserKind::kAdamW,
                       .rate = recipe.rate,
                       .momentum = 0.9,
                       .weight_decay = recipe.weight_decay,
                       .clip = 1},
                      JointMlp::kParameters);
  JointMlp best = mlp;
  double best_val = ScoreJointMlp(mlp, val).abs_rel;
  std::vector<Eigen::Index> order(train.size());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::vector<float> gradient;
  for (int epoch = 0; epoch < recipe.epochs; ++epoch) {
    const double rate = recipe.rate * RateShare(epoch, recipe.epochs, 1 + recipe.epochs / 20);
    for (std::size_t i = order.size() - 1; i > 0; --i) {
      std::swap(order[i], order[random() % (i + 1)]);
    }
    for (Eigen::Index begin = 0; begin < n; begin += recipe.batch) {
      const Eigen::Index count = std::min<Eigen::Index>(recipe.batch, n - begin);
      const std::vector<Eigen::Index> picked(order.begin() + begin, order.begin() + begin + count);
      JointMlpLoss(mlp, inputs(Eigen::all, picked), log_m(picked), &gradient);
      JointMlp::Parameters next = mlp.parameters();
      if (!optimiser.Step(rate, gradient, &next.weights)) return best;
      mlp = JointMlp(std::move(next));
    }
    if ((epoch + 1) % recipe.validate_every != 0 && epoch + 1 != recipe.epochs) continue;
    const double now = ScoreJointMlp(mlp, val).abs_rel;
    if (!(now < best_val)) continue;
    best_val = now;
    best = mlp;
  }
  JointMlp::Parameters chosen = best.parameters();
  chosen.range_sigma = std::min(ScoreJointMlp(best, val).rms_rel, 9.0);
  return JointMlp(std::move(chosen));
}

PcmScore ScoreJointMlp(const JointMlp& mlp, std::span<const PcmSample> samples) {
  std::vector<RangedSample> ranged;
  for (const PcmSample& sample : samples) {
    ranged.push_back({std::exp(mlp.LogRange(JointMlp::InputsOf(sample.boxes))), sample.label_m, 0});
  }
  return Score(ranged);
}

}  // namespace windhover
