// Networks, losses and optimisers against libtorch's: modules one by one, autograd, torch.optim.
// Built with -DWINDHOVER_TORCH=ON only.

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <torch/torch.h>

#include "common/random/random_stream.h"
#include "estimator/mixer_pass.h"
#include "learn/optimiser.h"
#include "learn/train_joint_mlp.h"
#include "learn/train_pcm.h"

namespace windhover {
namespace {

using torch::Tensor;

const auto kDouble = torch::TensorOptions().dtype(torch::kDouble);

/// The token or channel MLP of a mixer.
struct MlpImpl : torch::nn::Module {
  MlpImpl(int width, int hidden)
      : in(register_module("in", torch::nn::Linear(width, hidden))),
        out(register_module("out", torch::nn::Linear(hidden, width))) {}
  Tensor forward(const Tensor& x) { return out(torch::gelu(in(x))); }
  torch::nn::Linear in, out;
};
TORCH_MODULE(Mlp);

torch::nn::LayerNorm Norm(int width) {
  return torch::nn::LayerNorm(torch::nn::LayerNormOptions({width}));
}

struct BlockImpl : torch::nn::Module {
  explicit BlockImpl(int width)
      : token_norm(register_module("token_norm", Norm(width))),
        tokens(register_module("tokens", Mlp(4, 16))),
        channel_norm(register_module("channel_norm", Norm(width))),
        channels(register_module("channels", Mlp(width, width / 2))) {}
  Tensor forward(Tensor x) {  // boxes x tokens x channels
    x = x + tokens(token_norm(x).transpose(1, 2)).transpose(1, 2);
    return x + channels(channel_norm(x));
  }
  torch::nn::LayerNorm token_norm;
  Mlp tokens;
  torch::nn::LayerNorm channel_norm;
  Mlp channels;
};
TORCH_MODULE(Block);

struct NetworkImpl : torch::nn::Module {
  NetworkImpl(int width, int n_outputs)
      : embedding(register_module("embedding", torch::nn::Linear(1, width))),
        first(register_module("first", Block(width))),
        second(register_module("second", Block(width))),
        norm(register_module("norm", Norm(width))),
        head(register_module("head", torch::nn::Linear(width, n_outputs))) {
    to(torch::kDouble);
  }
  Tensor forward(const Tensor& tokens) {  // boxes x 4
    const Tensor x = second(first(embedding(tokens.unsqueeze(2))));
    const Tensor out = head(norm(x).mean(1));
    return out.size(1) == 1 ? torch::tanh(out) : out;
  }
  torch::nn::Linear embedding;
  Block first, second;
  torch::nn::LayerNorm norm;
  torch::nn::Linear head;
};
TORCH_MODULE(Network);

/// Parameters in the order in which modules were registered: that of ours.
void Set(const std::vector<double>& values, torch::nn::Module* module) {
  const torch::NoGradGuard no_gradient;
  std::size_t at = 0;
  for (Tensor& parameter : module->parameters()) {
    double* to = parameter.data_ptr<double>();
    for (std::int64_t i = 0; i < parameter.numel(); ++i) to[i] = values.at(at++);
  }
  ASSERT_EQ(at, values.size());
}

std::vector<double> GradientOf(const torch::nn::Module& module) {
  std::vector<double> gradient;
  for (const Tensor& parameter : module.parameters()) {
    const Tensor of = parameter.grad().contiguous();
    gradient.insert(gradient.end(), of.data_ptr<double>(), of.data_ptr<double>() + of.numel());
  }
  return gradient;
}

std::vector<double> Normal(int n, double sigma, const char* name) {
  RandomStream random(1, name);
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(static_cast<float>(sigma * random.Normal()));
  return values;
}

std::vector<float> Floats(const std::vector<double>& values) {
  return {values.begin(), values.end()};
}

double Largest(const std::vector<double>& values) {
  double largest = 0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Every number to `tolerance` of the largest.
void ExpectNear(const std::vector<double>& have, const std::vector<double>& want,
                double tolerance) {
  ASSERT_EQ(have.size(), want.size());
  ASSERT_GT(Largest(want), 0);
  double worst = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    worst = std::max(worst, std::abs(have[i] - want[i]) / Largest(want));
  }
  EXPECT_LT(worst, tolerance);
  std::printf("worst difference: %.1e of the largest\n", worst);
}

template <int kWidth, int kOutputs>
void CheckPass() {
  const auto p = Normal(MixerParameters(kWidth, kOutputs), 0.4, "parameters");
  const auto x = Normal(40, 0.5, "tokens"), weights = Normal(10 * kOutputs, 1, "weights");
  using Pass = MixerPass<kWidth, kOutputs, double, true>;
  const auto pass = std::make_unique<Pass>();
  std::vector<double> outputs, gradient(p.size());
  for (std::size_t box = 0; box < 10; ++box) {
    typename Pass::Outputs out, slope;
    pass->Forward(p.data(), {x[4 * box], x[4 * box + 1], x[4 * box + 2], x[4 * box + 3]}, &out);
    outputs.insert(outputs.end(), out.begin(), out.end());
    for (std::size_t k = 0; k < kOutputs; ++k) slope[k] = weights[box * kOutputs + k];
    pass->Backward(p.data(), slope, gradient.data());
  }
  Network network(kWidth, kOutputs);
  Set(p, network.get());
  const Tensor want = network(torch::tensor(x, kDouble).view({10, 4}));
  (want * torch::tensor(weights, kDouble).view({10, kOutputs})).sum().backward();
  const double* wanted = want.data_ptr<double>();
  ExpectNear(outputs, {wanted, wanted + want.numel()}, 1e-12);
  ExpectNear(gradient, GradientOf(*network), 1e-11);
  std::vector<double> floats;
  const Mixer mixer(kWidth, kOutputs, Floats(p));
  for (std::size_t box = 0; box < 10; ++box) {
    BoxTokens tokens;
    for (std::size_t i = 0; i < 4; ++i) tokens[i] = static_cast<float>(x[4 * box + i]);
    const auto out = mixer.Evaluate(tokens, tokens)[0];
    floats.insert(floats.end(), out.begin(), out.begin() + kOutputs);
  }
  ExpectNear(floats, outputs, 1e-5);  // Sums of hundreds of floats, Φ to 2e-7.
}

TEST(Torch, AgreesOnMixersForwardAndBack) {
  CheckPass<4, 1>();
  CheckPass<4, 2>();
  CheckPass<96, 1>();
  CheckPass<96, 2>();
}

std::vector<PcmSample> Samples() {
  const StereoRig rig = CalibratedRig{}.ToStereoRig();
  RandomStream random(3, "samples");
  std::vector<PcmSample> samples;
  for (int i = 0; i < 50; ++i) {
    const double z_m = random.Uniform(4, 40), f_px = rig.left.fx_px();
    const double disparity_px = f_px * rig.baseline_m / z_m + 70;
    const double x_px = random.Uniform(400, 800), y_px = random.Uniform(200, 500);
    stereo_box_t box{};
    box.left = {x_px + disparity_px / 2, y_px, 0.9 * f_px / z_m, 0.4 * f_px / z_m};
    box.right = {x_px - disparity_px / 2, y_px + 2, box.left.w_px * 1.1, box.left.h_px};
    samples.push_back({*MakeCorrectable(rig, box), static_cast<float>(z_m)});
  }
  return samples;
}

/// All that torch needs of some samples; one row each.
struct Batch {
  Tensor left, right, disparity, range, label;

  explicit Batch(const std::vector<PcmSample>& samples) {
    std::vector<double> tokens[2], d, r, l;
    for (const PcmSample& sample : samples) {
      for (int side = 0; side < 2; ++side) {
        const BoxTokens of = TokensOf(sample.boxes, side);
        tokens[side].insert(tokens[side].end(), of.begin(), of.end());
      }
      d.push_back(sample.boxes.Disparity());
      r.push_back(sample.boxes.range_m);
      l.push_back(sample.label_m);
    }
    left = torch::tensor(tokens[0], kDouble).view({-1, 4});
    right = torch::tensor(tokens[1], kDouble).view({-1, 4});
    disparity = torch::tensor(d, kDouble);
    range = torch::tensor(r, kDouble);
    label = torch::tensor(l, kDouble);
  }
  Tensor Corrected_m(Network& network) const {
    return range / (disparity + (network(left) - network(right)).squeeze(1));
  }
};

Tensor LossOf(PcmLoss loss, const Tensor& d_m, const Tensor& label_m) {
  if (loss == PcmLoss::kSquared) return torch::mse_loss(d_m, label_m);
  return torch::huber_loss(torch::log(d_m / label_m), torch::zeros_like(d_m), at::Reduction::Mean,
                           0.1);
}

/// What one step of the trainer, at a rate that makes it as long as 1 by torch's gradient, takes
/// from the parameters of the first module or of the first gate.
std::vector<double> StepOf(const PcmStages& start, PcmLoss loss, double length, double threshold,
                           bool of_gate) {
  PcmRecipe recipe = PaperRecipe();
  recipe.epochs = recipe.validate_every = 1;
  recipe.loss = loss;
  recipe.lambda = 2;
  recipe.threshold = threshold;
  recipe.optimiser = {.rate = 1 / length, .momentum = 0, .weight_decay = 0, .clip = 0};
  const auto samples = Samples();
  PcmTrainer trainer(samples, samples, recipe, start);
  trainer.Finish();
  const PcmStages after = trainer.Best();
  const auto& p = (of_gate ? start.gates : start.offsets)[0].parameters();
  const auto& q = (of_gate ? after.gates : after.offsets)[0].parameters();
  std::vector<double> step;
  for (std::size_t i = 0; i < p.size(); ++i) step.push_back(static_cast<double>(p[i]) - q[i]);
  return step;
}

double Length(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares);
}

TEST(Torch, AgreesOnTheGradientsOfTheLosses) {
  const auto p = Normal(393, 0.2, "offsets"), g = Normal(398, 0.2, "gate");
  const Mixer offsets(4, 1, Floats(p)), gate(4, 2, Floats(g));
  const PcmStages start{{offsets, offsets}, {gate}, std::nullopt};
  const Batch batch(Samples());
  for (const PcmLoss loss : {PcmLoss::kSquared, PcmLoss::kLog}) {
    Network network(4, 1), judge(4, 2);
    Set(p, network.get());
    Set(g, judge.get());
    const Tensor corrected_m = batch.Corrected_m(network);
    LossOf(loss, corrected_m, batch.label).backward();
    std::vector<double> gradient = GradientOf(*network);
    const double length = Length(gradient);
    for (double& value : gradient) value /= length;
    // Half of the samples are hard; none is at the edge.
    const Tensor error = torch::abs(corrected_m.detach() - batch.label) / batch.label;
    const double threshold = 1.001 * error.median().item<double>();
    const Tensor hard = (error > threshold).to(torch::kLong);
    ASSERT_EQ(hard.sum().item<int>(), 25);
    // Floats: 6e-8 of parameters as large as the step.
    ExpectNear(StepOf(start, loss, length, threshold, false), gradient, 1e-4);

    const Tensor logits = (judge(batch.left) + judge(batch.right)) / 2;
    (2 * torch::nn::functional::cross_entropy(logits, hard)).backward();
    std::vector<double> of_gate = GradientOf(*judge);
    const double gate_length = Length(of_gate);
    for (double& value : of_gate) value /= gate_length;
    ExpectNear(StepOf(start, loss, gate_length, threshold, true), of_gate, 1e-4);
  }
}

TEST(Torch, AgreesOnTheJointNetwork) {
  JointMlp::Parameters parameters;
  parameters.mean.setConstant(0.1f);
  parameters.scale.setConstant(1.5f);
  parameters.mean_log_m = 2.5f;
  const auto p = Normal(JointMlp::kParameters, 0.3, "joint");
  parameters.weights = Floats(p);
  const JointMlp mlp(parameters);
  const auto samples = Samples();
  Eigen::MatrixXf inputs(8, 50);
  Eigen::VectorXf log_m(50);
  std::vector<double> scaled, labels, have;
  for (int i = 0; i < 50; ++i) {
    const auto& sample = samples[static_cast<std::size_t>(i)];
    inputs.col(i) = JointMlp::InputsOf(sample.boxes);
    log_m[i] = std::log(sample.label_m);
    for (int k = 0; k < 8; ++k) scaled.push_back((inputs(k, i) - 0.1) / 1.5);
    labels.push_back(log_m[i]);
    have.push_back(mlp.LogRange(inputs.col(i)));
  }
  torch::nn::Sequential network(torch::nn::Linear(8, 32), torch::nn::SiLU(),
                                torch::nn::Linear(32, 32), torch::nn::SiLU(),
                                torch::nn::Linear(32, 1));
  network->to(torch::kDouble);
  Set(p, network.get());
  const Tensor out =
      network->forward(torch::tensor(scaled, kDouble).view({50, 8})).squeeze(1) + 2.5;
  const double* wanted = out.data_ptr<double>();
  ExpectNear(have, {wanted, wanted + 50}, 1e-6);
  const Tensor loss =
      torch::huber_loss(out, torch::tensor(labels, kDouble), at::Reduction::Mean, 0.05);
  loss.backward();
  std::vector<float> gradient;
  EXPECT_NEAR(JointMlpLoss(mlp, inputs, log_m, &gradient), loss.item<double>(), 1e-6);
  ExpectNear({gradient.begin(), gradient.end()}, GradientOf(*network), 1e-5);
}

TEST(Torch, AgreesOnOptimisers) {
  const auto start = Normal(60, 1, "start");
  for (const OptimiserKind kind : {OptimiserKind::kSgd, OptimiserKind::kAdamW}) {
    Optimiser ours({.kind = kind, .rate = 0.01, .momentum = 0.9, .weight_decay = 0.1, .clip = 1},
                   start.size());
    std::vector<float> p = Floats(start);
    const Tensor q = torch::tensor(start, kDouble).requires_grad_();
    std::unique_ptr<torch::optim::Optimizer> theirs;
    if (kind == OptimiserKind::kSgd) {
      const auto options = torch::optim::SGDOptions(0.01).momentum(0.9).weight_decay(0.1);
      theirs = std::make_unique<torch::optim::SGD>(std::vector<Tensor>{q}, options);
    } else {
      const auto options = torch::optim::AdamWOptions(0.01).weight_decay(0.1);
      theirs = std::make_unique<torch::optim::AdamW>(std::vector<Tensor>{q}, options);
    }
    for (int i = 0; i < 30; ++i) {
      // Longer than 1 half of the time: clipped.
      const auto gradient = Normal(60, i % 2 == 0 ? 1 : 0.05, std::to_string(i).c_str());
      ours.Step(0.01, Floats(gradient), &p);
      q.mutable_grad() = torch::tensor(gradient, kDouble);
      torch::nn::utils::clip_grad_norm_({q}, 1.0);
      theirs->step();
    }
    const double* wanted = q.data_ptr<double>();
    ExpectNear({p.begin(), p.end()}, {wanted, wanted + 60}, 1e-6);  // 30 steps of floats.
  }
}

}  // namespace
}  // namespace windhover
