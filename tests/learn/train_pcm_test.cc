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

TEST(PcmScore, OfAWorkedExample) {
  // Errors of 20 %, 0 and, for no distance, 1.
  const RangedSample samples[] = {{12, 10, 1}, {30, 30, 2}, {-5, 40, 3}};
  const PcmScore score = Score(samples);
  EXPECT_NEAR(score.abs_rel, 1.2 / 3, 1e-6);
  EXPECT_NEAR(score.sq_rel, (4.0 / 10 + 40) / 3, 1e-5);
  EXPECT_NEAR(score.lt20, 0.2, 1e-6);
  EXPECT_NEAR(score.gt20, 0.5, 1e-6);
  EXPECT_NEAR(score.rms_rel, std::sqrt(1.04 / 3), 1e-6);
  EXPECT_EQ(score.n_stages, 2);
}

TEST(PcmLoss, SlopesAreThoseOfDifferences) {
  CorrectableBoxes boxes = Samples(1, "loss")[0].boxes;
  const double label_m = 12, h = 1e-6;
  for (const double ratio : {0.5, 0.8, 0.97, 1.04, 1.3, 3.0}) {  // Distance to label.
    const double disparity = boxes.range_m / (ratio * label_m);
    const auto slope_of = [&](PcmLoss loss) {
      return SlopeOf(loss, boxes, static_cast<float>(disparity), static_cast<float>(label_m));
    };
    const auto squared = [&](double x) { return std::pow(boxes.range_m / x - label_m, 2); };
    const auto huber = [&](double x) {
      const double a = std::abs(std::log(boxes.range_m / x / label_m));
      return a < 0.1 ? a * a / 2 : 0.1 * (a - 0.05);
    };
    const double by_squared = (squared(disparity + h) - squared(disparity - h)) / (2 * h);
    const double by_huber = (huber(disparity + h) - huber(disparity - h)) / (2 * h);
    // Floats of ratios near 1, and differences of second order.
    EXPECT_NEAR(slope_of(PcmLoss::kSquared).by_disparity / by_squared, 1, 1e-4) << ratio;
    EXPECT_NEAR(slope_of(PcmLoss::kLog).by_disparity / by_huber, 1, 1e-4) << ratio;
    EXPECT_NEAR(slope_of(PcmLoss::kLog).relative_error, std::abs(ratio - 1), 1e-5);
  }
  // The authors take the distance of either sign's parallax; ours leads back to parallax.
  EXPECT_GT(SlopeOf(PcmLoss::kSquared, boxes, -0.01f, 1).by_disparity, 0);
  EXPECT_LT(SlopeOf(PcmLoss::kLog, boxes, -0.01f, 12).by_disparity, 0);
  // Cross entropy log(1 + exp(∓margin)) of a gate that is 0.5 towards hard.
  EXPECT_NEAR(GateSlopeOf(0.5f, true), -1 / (1 + std::exp(0.5)), 1e-6);
  EXPECT_NEAR(GateSlopeOf(0.5f, false), 1 / (1 + std::exp(-0.5)), 1e-6);
}

TEST(Optimiser, StepsOfAWorkedExample) {
  std::vector<float> p = {1, -2};
  Optimiser sgd({.rate = 1, .momentum = 0.5, .weight_decay = 0.1, .clip = 1}, 2);
  EXPECT_TRUE(sgd.Step(0.1, {0.3f, 0.4f}, &p));  // Velocity 0.3 + 0.1, 0.4 - 0.2.
  EXPECT_FLOAT_EQ(p[0], 0.96f);
  EXPECT_FLOAT_EQ(p[1], -2.02f);
  EXPECT_TRUE(sgd.Step(0.1, {3, 4}, &p));  // Clipped to 0.6, 0.8, on half the velocity.
  EXPECT_NEAR(p[0], 0.96 - 0.1 * (0.2 + 0.6 + 0.096), 1e-6);
  EXPECT_NEAR(p[1], -2.02 - 0.1 * (0.1 + 0.8 - 0.202), 1e-6);
  EXPECT_FALSE(sgd.Step(0.1, {NAN, 0}, &p));
  EXPECT_NEAR(p[0], 0.8704, 1e-6);

  p = {1, -2};
  Optimiser adam({.kind = OptimiserKind::kAdamW, .momentum = 0.9, .weight_decay = 0.1, .clip = 0},
                 2);
  EXPECT_TRUE(adam.Step(0.01, {3, -4}, &p));  // First steps are as long as the rate.
  EXPECT_NEAR(p[0], 1 - 0.01 * (0.1 + 1), 1e-6);
  EXPECT_NEAR(p[1], -2 - 0.01 * (-0.2 - 1), 1e-6);
  const double before = p[0];
  EXPECT_TRUE(adam.Step(0.01, {1, 0}, &p));
  const double first = (0.9 * 0.3 + 0.1) / (1 - 0.81), second = (0.999 * 9e-3 + 1e-3) / 1.999e-3;
  EXPECT_NEAR(p[0], before - 0.01 * (0.1 * before + first / std::sqrt(second)), 1e-6);
}

TEST(Optimiser, RatesWarmUpAndFall) {
  EXPECT_EQ(RateShare(0, 100, 4), 0.25);
  EXPECT_EQ(RateShare(3, 100, 4), 1);
  EXPECT_EQ(RateShare(4, 100, 4), 1);
  EXPECT_NEAR(RateShare(52, 100, 4), 0.5, 1e-12);
  EXPECT_LT(RateShare(99, 100, 4), 1e-3);
  EXPECT_GT(RateShare(99, 100, 4), 0);
}

// One pair, one short step: every module and the gate err less by what they were punished for.
TEST(TrainPcm, StepsDownTheGradientOfItsLoss) {
  const auto one = Samples(1, "step");
  RandomStream random(9, "start");
  std::vector<float> p;
  for (int i = MixerParameters(4, 1); i > 0; --i)
    p.push_back(static_cast<float>(0.1 * random.Normal()));
  std::vector<float> g(p);
  for (int i = 0; i < 5; ++i) g.push_back(static_cast<float>(0.3 * random.Normal()));
  const PcmStages start{{Mixer(4, 1, p), Mixer(4, 1, p)}, {Mixer(4, 2, g)}, std::nullopt};
  PcmRecipe recipe = PaperRecipe();
  recipe.epochs = recipe.validate_every = 1;
  recipe.optimiser = {.rate = 1e-4, .momentum = 0, .weight_decay = 0, .clip = 1};
  PcmTrainer trainer(one, one, recipe, start);
  trainer.Finish();
  const PcmStages after = trainer.Best();
  const auto error = [&](const std::vector<float>& parameters, const CorrectableBoxes& from) {
    const auto out = Mixer(4, 1, parameters).Evaluate(TokensOf(from, 0), TokensOf(from, 1));
    const double disparity = static_cast<double>(from.Disparity()) + out[0][0] - out[1][0];
    return std::pow(from.range_m / std::abs(disparity) - one[0].label_m, 2);
  };
  const CorrectableBoxes& boxes = one[0].boxes;
  EXPECT_LT(error(after.offsets[0].parameters(), boxes), error(p, boxes));
  // The second stage learns from what the first made of the boxes before its step.
  ASSERT_GT(std::sqrt(error(p, boxes)) / one[0].label_m, recipe.threshold);
  CorrectableBoxes corrected = boxes;
  const auto out = Mixer(4, 1, p).Evaluate(TokensOf(boxes, 0), TokensOf(boxes, 1));
  for (std::size_t side = 0; side < 2; ++side) corrected.x[side] += out[side][0];
  EXPECT_LT(error(after.offsets[1].parameters(), corrected), error(p, corrected));
  // The gate moves towards "hard".
  const auto margin = [&](const Mixer& gate) {
    const auto logits = gate.Evaluate(TokensOf(boxes, 0), TokensOf(boxes, 1));
    return logits[0][1] + logits[1][1] - logits[0][0] - logits[1][0];
  };
  EXPECT_GT(margin(after.gates[0]), margin(start.gates[0]));
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
