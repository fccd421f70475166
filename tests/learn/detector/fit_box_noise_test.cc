#include "learn/detector/fit_box_noise.h"

#include <cmath>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "learn/detector/detector_trial.h"
#include "rig/fitted_box_noise.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

/// Targets of 15 to 300 px, as the noise of `observe: geometric` errs.
std::vector<BoxErrorSample> Drawn(const GeometricConfig& config, int n) {
  const BoxNoise noise(config, 7, "test");
  RandomStream stream(1, "sizes");
  std::vector<BoxErrorSample> samples;
  for (int i = 0; i < n; ++i) {
    const double width_px = 15 * std::pow(20.0, stream.Uniform());
    BoxErrorSample sample;
    sample.sizes = {{{width_px, 0.4 * width_px}, {width_px, 0.4 * width_px}}};
    sample.errors = noise.At(i, sample.sizes[0], sample.sizes[1]);
    samples.push_back(sample);
  }
  return samples;
}

GeometricConfig Known() {
  GeometricConfig config;
  config.sigma_px = 0.6;
  config.sigma_relative = 0.012;
  config.size_factor = 1.7;
  config.correlation = 0.4;
  config.gross_rate = 0;
  config.miss_rate = 0.02;
  config.miss_width_px = 25;
  config.miss_softness_px = 4;
  return config;
}

// 20,000 targets have some 80,000 centre errors: deviations come out to 1 / sqrt(2 · 80,000) =
// 0.25 %, less well where two terms share them; the limits are five to ten times that.
TEST(FitBoxNoise, FindsTheNoiseThatMadeTheErrors) {
  const GeometricConfig known = Known(), fitted = FitBoxNoise(Drawn(known, 20000));
  EXPECT_NEAR(fitted.sigma_px, known.sigma_px, 0.02);
  EXPECT_NEAR(fitted.sigma_relative, known.sigma_relative, 0.0003);
  EXPECT_NEAR(fitted.size_factor, known.size_factor, 0.04);
  EXPECT_NEAR(fitted.correlation, known.correlation, 0.03);
  EXPECT_NEAR(fitted.gross_rate, 0, 0.002) << "one normal error in 2,000 is beyond 3.5 deviations";
  EXPECT_NEAR(MissProbability(fitted, 15), MissProbability(known, 15), 0.03);
  EXPECT_NEAR(MissProbability(fitted, 25), MissProbability(known, 25), 0.03);
  EXPECT_NEAR(MissProbability(fitted, 200), MissProbability(known, 200), 0.01);
}

// A gross error of 0.5 sizes is beyond 3.5 deviations in all but some 8 % of the boxes.
TEST(FitBoxNoise, TellsGrossErrorsFromTheRest) {
  GeometricConfig known = Known();
  known.gross_rate = 0.08;
  known.gross_sigma = 0.5;
  const GeometricConfig fitted = FitBoxNoise(Drawn(known, 20000));
  EXPECT_NEAR(fitted.sigma_px, known.sigma_px, 0.04);
  EXPECT_NEAR(fitted.gross_rate, 0.08, 0.01);
  EXPECT_NEAR(fitted.gross_sigma, 0.5, 0.03);
}

// What both images err alike, 0.3 sizes every tenth time, moves no distance: neither gross nor less
// correlated. With a correlation of 0.97 left and right differ by 0.24 deviations.
TEST(FitBoxNoise, WhatBothErrAlikeIsNotGross) {
  GeometricConfig known = Known();
  known.correlation = 0.97;
  auto samples = Drawn(known, 20000);
  for (std::size_t i = 0; i < samples.size(); i += 10) {
    if (!samples[i].errors) continue;
    for (auto* error : {&samples[i].errors->left, &samples[i].errors->right}) {
      error->x += 0.3 * samples[i].sizes[0][0];
    }
  }
  const GeometricConfig fitted = FitBoxNoise(samples);
  EXPECT_NEAR(fitted.sigma_relative, known.sigma_relative, 0.0006);
  EXPECT_NEAR(fitted.correlation, 0.97, 0.003);
  EXPECT_NEAR(fitted.gross_rate, 0, 0.002);
}

TEST(FitBoxNoise, FindsTheWidthWhereImagesDifferMore) {
  GeometricConfig known = Known();
  known.correlation = 0.97;
  known.correlation_width_px = 80;
  const GeometricConfig fitted = FitBoxNoise(Drawn(known, 20000));
  EXPECT_NEAR(fitted.correlation, 0.97, 0.003);
  EXPECT_NEAR(fitted.correlation_width_px, 80, 8) << "five deviations";
  EXPECT_NEAR(fitted.gross_rate, 0, 0.003);
}

TEST(FitBoxNoise, FindsWhereNothingIsMissed) {
  GeometricConfig known = Known();
  known.miss_rate = known.miss_width_px = 0;
  const GeometricConfig fitted = FitBoxNoise(Drawn(known, 500));
  EXPECT_EQ(fitted.miss_rate, 0);
  EXPECT_EQ(MissProbability(fitted, 1), 0);
}

TEST(FitBoxNoise, NeedsSomethingToFit) {
  EXPECT_THROW(FitBoxNoise({}), std::invalid_argument);
  EXPECT_THROW(FitBoxNoise(std::vector<BoxErrorSample>(100)), std::invalid_argument);
}

TEST(FittedBoxNoise, IsReadFromTheCardOfADetector) {
  const TemporaryFolder folder;
  DetectorCard card;
  card.network = "yolox_nano";
  card.detector = card.refiner.emplace(DetectorCard::Weights{"w.onnx", std::string(64, '0')});
  card.box_noise = BoxNoiseJson(Known());
  InputFile file{"c.json", folder.Write("c.json", DetectorCardText(card)), "s.yaml:2:3"};
  const GeometricConfig read = ReadFittedBoxNoise(file);
  EXPECT_EQ(BoxNoiseJson(read), BoxNoiseJson(Known()));
  EXPECT_EQ(read.noise, BoxNoiseSource::kFitted);

  card.box_noise["correlation"] = 3;
  folder.Write("c.json", DetectorCardText(card));
  const auto message = [&] {
    try {
      ReadFittedBoxNoise(file);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(message(), HasSubstr("s.yaml:2:3: "));
  EXPECT_THAT(message(), HasSubstr("box_noise.correlation: must be a number from -"));
  card.box_noise = nullptr;
  folder.Write("c.json", DetectorCardText(card));
  EXPECT_THAT(message(), HasSubstr("box_noise: must be there (found nothing)"));
}

TEST(FittedBoxNoise, IsWhatAScenarioFliesWith) {
  const TemporaryFolder folder;
  DetectorCard card;
  card.network = "yolox_small";
  card.detector = {"w.onnx", std::string(64, '0')};
  card.box_noise = BoxNoiseJson(Known());
  folder.Write("c.json", DetectorCardText(card));
  const auto scenario = [&](const std::string& noise) {
    return LoadScenario(
        folder.Write("s.yaml",
                     "description: x\n"
                     "aircraft: [{id: 0, carries_rig: true}, {id: 1, position_m: [9, 0, 0]}]\n"
                     "estimator: {detector_model: c.json}\n"
                     "geometric: {noise: " +
                         noise + "}\n"));
  };
  const Scenario fitted = scenario("fitted");
  EXPECT_EQ(BoxNoiseJson(fitted.geometric), BoxNoiseJson(Known()));
  EXPECT_NE(BoxNoiseJson(scenario("preset").geometric), BoxNoiseJson(Known()));
  // What a run keeps of itself says all, without the card.
  const Scenario again = ScenarioFromYaml(ResolvedYaml(fitted, PathStyle::kAsGiven), "resolved");
  EXPECT_EQ(BoxNoiseJson(again.geometric), BoxNoiseJson(Known()));
}

image_box_t Box(double x, double w) {
  image_box_t box{};
  box.x_px = x;
  box.y_px = 100;
  box.w_px = w;
  box.h_px = w / 2;
  return box;
}

stereo_box_t Detection(double left, double right, double score = 0.9) {
  stereo_box_t box{};
  box.score = score;
  box.left = Box(left, 40);
  box.right = Box(right, 40);
  return box;
}

// Found 1 px to the right in left and 3 px in right; missed; and one in an empty pair.
TEST(DetectorTrial, WorkedExample) {
  std::vector<TriedPair> pairs(3);
  for (int i = 0; i < 2; ++i) {
    auto& eyes = pairs[static_cast<std::size_t>(i)].result.eyes;
    eyes[0].labels = {{.box = Box(500, 40), .range_m = 10}};
    eyes[1].labels = {{.box = Box(400, 40), .range_m = 10}};
    eyes[0].found = {{Box(500, 40), 0.9}};
  }
  pairs[0].detections = {Detection(700, 600), Detection(501, 403)};
  pairs[2].detections = {Detection(300, 200)};
  const TrialScore score = ScoreTrial(pairs);
  EXPECT_EQ(score.bins[0].n, 2);
  EXPECT_EQ(score.bins[0].n_found, 1);
  EXPECT_EQ(score.bins[0].centre_px, 3) << "the upper of both";
  EXPECT_EQ(score.bins[0].difference_px, 2);
  EXPECT_EQ(score.bins[0].bias_px, 2);
  EXPECT_EQ(score.bins[2].n, 2);
  EXPECT_EQ(score.bins[2].from_m, 8);
  EXPECT_EQ(score.bins.size(), 3u) << "all, 4 to 30 m, 8 to 15 m";
  EXPECT_EQ(score.n_empty, 1);
  EXPECT_EQ(score.n_false, 1);
  EXPECT_EQ(score.n_beside, 1);
  // Two of four aircraft, without a false one: precision is 1 up to a recall of 0.5, 51 of 101.
  EXPECT_NEAR(score.ap50.value(), 51.0 / 101, 1e-9);
  ASSERT_EQ(score.sizes.size(), 1u) << "32 to 64 px";
  EXPECT_EQ(score.sizes[0].ap50, score.ap50);
  const auto samples = ErrorSamples(pairs);
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[0].errors->right.x, 3);
  EXPECT_EQ(samples[0].sizes[0][0], 40);
  EXPECT_FALSE(samples[1].errors);
}

// One of two targets with 0.8; something in an empty pair with 0.32: nothing from 0.35 on.
TEST(DetectorTrial, ChoosesAScoreThatIsQuiet) {
  std::vector<TriedPair> pairs(3);
  for (int i = 0; i < 2; ++i) {
    auto& eyes = pairs[static_cast<std::size_t>(i)].result.eyes;
    eyes[0].labels = {{.box = Box(500, 40), .range_m = 10}};
    eyes[1].labels = {{.box = Box(400, 40), .range_m = 10}};
  }
  pairs[0].detections = {Detection(500, 400, 0.8)};
  pairs[2].detections = {Detection(300, 200, 0.32), Detection(900, 850, 0.11)};
  const auto choices = ScoreChoices(pairs);
  ASSERT_EQ(choices.size(), 19u);
  EXPECT_EQ(choices[0].n_false, 2) << "0.05";
  EXPECT_EQ(choices[5].n_false, 1) << "0.30";
  EXPECT_EQ(choices[15].recall, 0.5) << "0.80";
  EXPECT_EQ(choices[16].recall, 0) << "0.85";
  EXPECT_NEAR(QuietScore(choices), 0.35, 1e-12);
  pairs[2].detections[0].score = 1;
  EXPECT_THROW(QuietScore(ScoreChoices(pairs)), std::invalid_argument);
}

}  // namespace
}  // namespace windhover
