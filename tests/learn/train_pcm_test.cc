#include "learn/train_pcm.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "common/random/random_stream.h"
#include "estimator/correction_card.h"
#include "estimator/mixer_pass.h"
#include "learn/mixer_kernel.h"
#include "learn/train_joint_mlp.h"

namespace windhover {
namespace {

/// Targets of one size before a rig whose disparities are 70 px too large, boxes 1 px noisy.
std::vector<PcmSample> Samples(int n, const char* name) {
  const StereoRig rig = CalibratedRig{}.ToStereoRig();
  RandomStream random(3, name);
  std::vector<PcmSample> samples;
  while (static_cast<int>(samples.size()) < n) {
    const double z_m = random.Uniform(4, 40), f_px = rig.left.fx_px();
    const double disparity_px = f_px * rig.baseline_m / z_m + 70;
    const double x_px = random.Uniform(400, 800), y_px = random.Uniform(200, 500);
    stereo_box_t box{};
    box.left = {x_px + disparity_px / 2 + random.Normal(), y_px, 0.9 * f_px / z_m,
                0.4 * f_px / z_m};
    box.right = {x_px - disparity_px / 2 + random.Normal(), y_px, box.left.w_px, box.left.h_px};
    samples.push_back({*MakeCorrectable(rig, box), static_cast<float>(z_m)});
  }
  return samples;
}

PcmRecipe Short() {
  PcmRecipe recipe = StableRecipe();
  recipe.epochs = 30;
  recipe.batch = 32;
  recipe.seed = 5;
  return recipe;
}

PcmTrainer Trained(const PcmRecipe& recipe) {
  PcmTrainer trainer(Samples(300, "train"), Samples(60, "val"), recipe);
  while (!trainer.finished()) EXPECT_TRUE(trainer.Advance());
  return trainer;
}

std::string CardOf(const PcmTrainer& trainer) {
  CorrectionCard card;
  card.pcm = trainer.Best();
  return CorrectionCardText(card);
}

TEST(MixerKernel, IsThePassOfOneBoxWhateverTheInstructions) {
  RandomStream random(1, "kernel");
  for (const int n_outputs : {1, 2}) {
    std::vector<float> p;
    for (int i = MixerParameters(4, n_outputs); i > 0; --i) {
      p.push_back(static_cast<float>(0.4 * random.Normal()));
    }
    MixerKernel::Tokens x;
    MixerKernel::Outputs slopes{}, out{}, first{};
    for (auto& row : x)
      for (float& v : row) v = static_cast<float>(random.Uniform());
    for (auto& row : slopes)
      for (float& v : row) v = static_cast<float>(random.Normal());
    std::vector<float> gradient, first_gradient;
    for (const InstructionSet isa :
         {InstructionSet::kSse2, InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      if (isa > WidestInstructionSet()) break;
      const auto kernel = MakeMixerKernel(4, n_outputs, isa);
      kernel->Forward(p.data(), x, &out);
      kernel->Backward(p.data(), slopes);
      kernel->TakeGradient(&gradient);
      if (isa == InstructionSet::kSse2) first = out, first_gradient = gradient;
      EXPECT_EQ(out, first);
      EXPECT_EQ(gradient, first_gradient);
    }
    // The sum over boxes of one box's gradient in doubles, as estimator.mixer_test proves it.
    MixerPass<4, 1, double, true> one;
    MixerPass<4, 2, double, true> two;
    const std::vector<double> p64(p.begin(), p.end());
    std::vector<double> want(p.size());
    for (std::size_t b = 0; b < 16; ++b) {
      const std::array<double, 4> tokens = {x[0][b], x[1][b], x[2][b], x[3][b]};
      std::array<double, 1> out1;
      std::array<double, 2> out2;
      if (n_outputs == 1) {
        one.Forward(p64.data(), tokens, &out1);
        one.Backward(p64.data(), {slopes[0][b]}, want.data());
      } else {
        two.Forward(p64.data(), tokens, &out2);
        two.Backward(p64.data(), {slopes[0][b], slopes[1][b]}, want.data());
      }
    }
    double largest = 0;
    for (const double g : want) largest = std::max(largest, std::abs(g));
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(gradient[i], want[i], 2e-5 * largest) << i;  // Floats: 6e-8, sums of hundreds.
    }
  }
}

TEST(TrainPcm, LearnsAConstantOffsetThatTriangulationCannotSee) {
  const auto test = Samples(200, "test");
  PcmRecipe recipe = Short();
  recipe.epochs = 200;
  const PcmTrainer trainer = Trained(recipe);
  PcmStages baseline{{Mixer(4, 1, std::vector<float>(393))}, {}, std::nullopt};
  EXPECT_GT(ScorePcm(baseline, FurtherStages::kNone, test).abs_rel, 0.4);
  // 1 px of noise is 0.02 at 20 m; a few epochs leave some more.
  EXPECT_LT(ScorePcm(trainer.Best(), FurtherStages::kNone, test).abs_rel, 0.15);
  EXPECT_LT(trainer.curve().back().val, trainer.curve().front().val);
}

TEST(TrainPcm, ThePapersRecipeLearnsToo) {
  PcmRecipe recipe = PaperRecipe();
  recipe.epochs = 100;
  recipe.n_stages = 1;
  const auto test = Samples(200, "test");
  EXPECT_LT(ScorePcm(Trained(recipe).Best(), FurtherStages::kNone, test).abs_rel, 0.4);
}

TEST(TrainPcm, OneSeedIsOneCard) {
  const std::string card = CardOf(Trained(Short()));
  EXPECT_EQ(CardOf(Trained(Short())), card);
  PcmRecipe other = Short();
  other.seed = 6;
  EXPECT_NE(CardOf(Trained(other)), card);
}

TEST(TrainPcm, GoesOnFromItsStateAsIfNothingHadHappened) {
  PcmTrainer half(Samples(300, "train"), Samples(60, "val"), Short());
  for (int i = 0; i < 17; ++i) half.Advance();
  PcmTrainer rest(Samples(300, "train"), Samples(60, "val"), Short());
  rest.Restore(half.State(), "training.state");
  EXPECT_EQ(rest.epochs_done(), 17);
  while (!rest.finished()) rest.Advance();
  EXPECT_EQ(CardOf(rest), CardOf(Trained(Short())));
}

TEST(TrainPcm, RefusesAStateThatIsNotIts) {
  PcmTrainer trainer(Samples(300, "train"), Samples(60, "val"), Short());
  const std::string state = trainer.State();
  EXPECT_THROW(trainer.Restore("", "x"), ConfigError);
  EXPECT_THROW(trainer.Restore(state.substr(0, state.size() / 2), "x"), ConfigError);
  PcmTrainer other(Samples(301, "train"), Samples(60, "val"), Short());
  EXPECT_THROW(other.Restore(state, "x"), ConfigError);
}

TEST(TrainPcm, KeepsTheBestWhenItDiverges) {
  PcmRecipe recipe = Short();
  recipe.optimiser = {.kind = OptimiserKind::kSgd, .rate = 1e30, .clip = 0};
  recipe.loss = PcmLoss::kSquared;
  PcmTrainer trainer(Samples(300, "train"), Samples(60, "val"), recipe);
  bool diverged = false;
  for (int i = 0; i < 30 && !diverged; ++i) diverged = !trainer.Advance();
  EXPECT_TRUE(diverged);
  const double error = ScorePcm(trainer.Best(), FurtherStages::kNone, Samples(60, "val")).abs_rel;
  EXPECT_TRUE(std::isfinite(error));
}

TEST(TrainPcm, FineTuningStartsWhereItIsTold) {
  const PcmStages start = Trained(Short()).Best();
  PcmRecipe recipe = Short();
  recipe.optimiser.rate = 0;
  PcmTrainer trainer(Samples(300, "train"), Samples(60, "val"), recipe, start);
  trainer.Advance();
  EXPECT_EQ(trainer.Best().offsets[1].parameters(), start.offsets[1].parameters());
  recipe.n_stages = 3;
  EXPECT_THROW(PcmTrainer(Samples(9, "train"), Samples(9, "val"), recipe, start),
               std::invalid_argument);
}

TEST(TrainJointMlp, GradientIsThatOfDifferences) {
  const auto samples = Samples(20, "train");
  JointMlp mlp = TrainJointMlp(samples, samples, {.epochs = 1});
  Eigen::MatrixXf inputs(JointMlp::kInputs, 20);
  Eigen::VectorXf log_m(20);
  for (int i = 0; i < 20; ++i) {
    inputs.col(i) = JointMlp::InputsOf(samples[static_cast<std::size_t>(i)].boxes);
    log_m[i] = std::log(samples[static_cast<std::size_t>(i)].label_m);
  }
  std::vector<float> gradient, unused;
  JointMlpLoss(mlp, inputs, log_m, &gradient);
  for (std::size_t i = 0; i < gradient.size(); i += 31) {
    const auto at = [&](float step) {
      JointMlp::Parameters p = mlp.parameters();
      p.weights[i] += step;
      return JointMlpLoss(JointMlp(p), inputs, log_m, &unused);
    };
    // Floats: the loss is 0.02 with 1e-9 of rounding, over a step of 2e-2.
    EXPECT_NEAR(gradient[i], (at(0.01f) - at(-0.01f)) / 0.02f, 2e-5);
  }
}

TEST(TrainJointMlp, Learns) {
  const auto mlp = TrainJointMlp(Samples(300, "train"), Samples(60, "val"), {.epochs = 60});
  EXPECT_LT(ScoreJointMlp(mlp, Samples(200, "test")).abs_rel, 0.05);
}

}  // namespace
}  // namespace windhover
