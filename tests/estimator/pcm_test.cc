#include "estimator/pcm.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "estimator/correction_card.h"
#include "estimator/triangulation.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

AircraftConfig Config() {
  AircraftConfig config;
  config.rig.distortion.k1 = -0.1;
  return config;
}

stereo_box_t Box(double left_px, double right_px, double y_px, double w_px) {
  stereo_box_t box{};
  box.left = {left_px, y_px, w_px, w_px / 2};
  box.right = {right_px, y_px, w_px * 1.02, w_px / 2};
  box.score = 1;
  return box;
}

/// A mixer that answers `bias` whatever it sees.
Mixer Constant(std::vector<float> bias) {
  std::vector<float> parameters(
      static_cast<std::size_t>(MixerParameters(4, static_cast<int>(bias.size()))));
  std::copy(bias.begin(), bias.end(), parameters.end() - static_cast<std::ptrdiff_t>(bias.size()));
  return {4, static_cast<int>(bias.size()), parameters};
}

Mixer Random(int n_outputs, std::uint64_t seed) {
  RandomStream random(seed, "mixer");
  std::vector<float> parameters;
  for (int i = MixerParameters(4, n_outputs); i > 0; --i) {
    parameters.push_back(static_cast<float>(0.2 * random.Normal()));
  }
  return {4, n_outputs, parameters};
}

PcmStages ThreeStages(const std::vector<float>& first_gate, const std::vector<float>& second_gate) {
  return {{Random(1, 1), Random(1, 2), Random(1, 3)},
          {Constant(first_gate), Constant(second_gate)},
          std::nullopt,
          {0.1, 0.2, 0.3}};
}

std::unique_ptr<RangeEstimator> Estimator(PcmStages stages, FurtherStages further,
                                          const AircraftConfig& config = Config()) {
  return std::make_unique<PositionCorrection>(config, std::move(stages), further);
}

TEST(Pcm, TokensOfAWorkedExample) {
  CorrectableBoxes boxes{.x = {1, 0.5f},
                         .y = {0.5f, 1},
                         .w = {0.25f, 0.5f},
                         .h = {0.125f, 1},
                         .range_m = 1,
                         .image_width_px = 1280,
                         .image_height_px = 720};
  // Right of the middle by 640 px, of a half diagonal of 734.3 px: a quarter turn from below.
  const BoxTokens left = TokensOf(boxes, 0), right = TokensOf(boxes, 1);
  EXPECT_FLOAT_EQ(left[0], 0.25f);
  EXPECT_NEAR(left[1], 640 / 734.3024, 1e-6);
  EXPECT_FLOAT_EQ(left[2], 0.25f);
  EXPECT_FLOAT_EQ(left[3], 0.125f);
  EXPECT_FLOAT_EQ(right[0], 0.5f);  // Straight below: half a turn.
  EXPECT_NEAR(right[1], 360 / 734.3024, 1e-6);
}

TEST(Pcm, WithoutAnOffsetBetweenCamerasItIsTriangulation) {
  for (const double focal_mm : {12.0, 16.0}) {
    AircraftConfig config = Config();
    config.rig.focal_mm = focal_mm;
    const auto pcm =
        Estimator({{Constant({0.01f})}, {}, std::nullopt}, FurtherStages::kNone, config);
    Triangulation baseline(config);
    for (const double right_px : {100.0, 500.0, 690.0}) {
      const StereoObservation seen{Box(700, right_px, 200, 60)};
      const auto have = pcm->Estimate(seen), want = baseline.Estimate(seen);
      ASSERT_TRUE(have && want);
      // Floats: 6e-8 of positions, of which 10 px of disparity are a hundredth.
      EXPECT_NEAR(have->range_m / want->range_m, 1, 2e-5);
      EXPECT_LT((have->p_RT_m / want->range_m - want->p_RT_m / want->range_m).norm(), 2e-5);
      EXPECT_EQ(have->n_stages, 1);
      EXPECT_NEAR(have->range_sigma_m, 0.1 * have->range_m, 1e-9);
    }
  }
}

TEST(Pcm, GatesDecideHowManyStagesFollow) {
  const std::vector<float> easy = {0.1f, 0}, hard = {0, 0.1f};
  const StereoObservation seen{Box(700, 400, 200, 60)};
  const auto stages = [&](const PcmStages& pcm, FurtherStages further) {
    return Estimator(pcm, further)->Estimate(seen)->n_stages;
  };
  EXPECT_EQ(stages(ThreeStages(easy, hard), FurtherStages::kByGate), 1);
  EXPECT_EQ(stages(ThreeStages(hard, easy), FurtherStages::kByGate), 2);
  EXPECT_EQ(stages(ThreeStages(hard, hard), FurtherStages::kByGate), 3);
  EXPECT_EQ(stages(ThreeStages(hard, hard), FurtherStages::kNone), 1);
  EXPECT_EQ(stages(ThreeStages(easy, easy), FurtherStages::kForAll), 3);
}

TEST(Pcm, EachStageStartsFromCorrectedPositions) {
  const auto boxes = *MakeCorrectable(Config().rig.ToStereoRig(), Box(700, 400, 200, 60));
  const PcmStages pcm = ThreeStages({0, 1}, {1, 0});
  CorrectableBoxes by_hand = boxes;
  for (int stage = 0; stage < 2; ++stage) {
    const auto offset = pcm.offsets[static_cast<std::size_t>(stage)].Evaluate(TokensOf(by_hand, 0),
                                                                              TokensOf(by_hand, 1));
    by_hand.x[0] += offset[0][0];
    by_hand.x[1] += offset[1][0];
  }
  const Correction corrected = Correct(pcm, boxes, FurtherStages::kByGate);
  EXPECT_EQ(corrected.boxes.x, by_hand.x);
  EXPECT_NE(by_hand.x, boxes.x);
}

TEST(Pcm, AModuleMayServeAlone) {
  PcmStages pcm = ThreeStages({0, 1}, {0, 1});
  const auto boxes = *MakeCorrectable(Config().rig.ToStereoRig(), Box(700, 400, 200, 60));
  pcm.alone = Constant({0.25f});
  const auto first = Correct(pcm, boxes, FurtherStages::kNone).boxes;
  EXPECT_NEAR(first.x[0] - boxes.x[0], std::tanh(0.25), 1e-6);
  const Correction all = Correct(pcm, boxes, FurtherStages::kByGate);
  EXPECT_EQ(all.boxes.x,
            Correct(ThreeStages({0, 1}, {0, 1}), boxes, FurtherStages::kByGate).boxes.x);
}

TEST(Pcm, WhatIsNoDistanceIsNoEstimate) {
  const auto pcm = Estimator({{Constant({0})}, {}, std::nullopt}, FurtherStages::kNone);
  EXPECT_FALSE(pcm->Estimate({Box(500, 500, 200, 60)}));
  EXPECT_FALSE(pcm->Estimate({Box(400, 500, 200, 60)}));
  EXPECT_FALSE(pcm->Estimate({Box(NAN, 500, 200, 60)}));
  EXPECT_FALSE(pcm->Estimate({Box(600, 500, 200, 0)}));
  EXPECT_TRUE(pcm->Estimate({Box(600, 500, 200, 60)}));
}

JointMlp::Parameters SomeMlp() {
  JointMlp::Parameters mlp;
  mlp.mean.setConstant(0.1f);
  mlp.scale.setConstant(2);
  mlp.weights.assign(JointMlp::kParameters, 0);
  mlp.weights.back() = std::log(3.0f);
  mlp.mean_log_m = std::log(5.0f);
  return mlp;
}

TEST(JointMlp, WithoutWeightsTheBiasesAreAll) {
  JointMlpEstimator mlp(Config(), JointMlp(SomeMlp()));
  EXPECT_NEAR(mlp.Estimate({Box(700, 400, 200, 60)})->range_m, 15, 1e-5);
}

TEST(JointMlp, InputsOfAWorkedExample) {
  const CorrectableBoxes boxes{.x = {0.7f, 0.6f},
                               .y = {0.55f, 0.45f},
                               .w = {0.2f, 0.05f},
                               .h = {0.4f, 0.1f},
                               .range_m = 2,
                               .image_width_px = 1280,
                               .image_height_px = 640};
  const JointMlp::Inputs inputs = JointMlp::InputsOf(boxes);
  EXPECT_NEAR(inputs[0], std::log(20.0), 1e-5);  // 2 / 0.1
  EXPECT_NEAR(inputs[1], std::log(0.05), 1e-6);  // √(0.2 · 0.05) / 2
  EXPECT_NEAR(inputs[2], std::log(0.05), 1e-6);  // √(0.4 · 0.1) · 640/1280 / 2
  EXPECT_NEAR(inputs[3], 0.15, 1e-6);            // Middle of both, from the image's.
  EXPECT_NEAR(inputs[4], 0, 1e-6);
  EXPECT_NEAR(inputs[5], 0.05, 1e-6);
  EXPECT_NEAR(inputs[6], std::log(4.0), 1e-6);
  EXPECT_NEAR(inputs[7], std::log(4.0), 1e-6);
  // Less than 5 px of disparity is as 5 px.
  CorrectableBoxes far = boxes;
  far.x[1] = 0.7f - 1.0f / 1280;
  EXPECT_NEAR(JointMlp::InputsOf(far)[0], std::log(2 * 1280 / 5.0), 1e-5);
}

TEST(JointMlp, OnePathThroughBothLayers) {
  JointMlp::Parameters mlp = SomeMlp();
  mlp.mean.setZero();
  mlp.mean[2] = 1;
  constexpr int kHidden = JointMlp::kHidden, kFirst = kHidden * (JointMlp::kInputs + 1);
  mlp.weights[5 * JointMlp::kInputs + 2] = 4;             // Input 2 to unit 5,
  mlp.weights[kFirst + 7 * kHidden + 5] = -3;             // to unit 7 of the second layer,
  mlp.weights[kFirst + kHidden * kHidden + 7] = 0.25f;    // with its bias,
  mlp.weights[kFirst + kHidden * (kHidden + 1) + 7] = 2;  // to the answer.
  JointMlp::Inputs inputs = JointMlp::Inputs::Zero();
  inputs[2] = 2;
  const auto silu = [](double x) { return x / (1 + std::exp(-x)); };
  const double unit = (2.0 - 1) / 2;
  EXPECT_NEAR(JointMlp(mlp).LogRange(inputs),
              std::log(5.0) + std::log(3.0) + 2 * silu(-3 * silu(4 * unit) + 0.25), 1e-6);
}

CorrectionCard SomeCard() {
  CorrectionCard card;
  card.priors = FittedPriors{.offset_px = 72.8, .size_log_m = 8.1};
  card.pcm = ThreeStages({0.1f, 0.7f}, {1e-8f, -3e5f});
  card.pcm->alone = Random(1, 4);
  card.joint_mlp = JointMlp(SomeMlp());
  card.provenance["command"] = "windhover train pcm";
  return card;
}

TEST(CorrectionCard, ComesBackBitByBit) {
  const std::string text = CorrectionCardText(SomeCard());
  const CorrectionCard back = ParseCorrectionCard(text, "card.json");
  EXPECT_EQ(CorrectionCardText(back), text);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.pcm->offsets[i].parameters(), SomeCard().pcm->offsets[i].parameters());
  }
  EXPECT_EQ(back.priors->offset_px, 72.8);
  EXPECT_EQ(back.provenance["command"], "windhover train pcm");
}

std::string MessageOf(const std::string& text) {
  try {
    ParseCorrectionCard(text, "card.json");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(CorrectionCard, SaysWhatIsWrongAndWhere) {
  nlohmann::ordered_json good = nlohmann::ordered_json::parse(CorrectionCardText(SomeCard()));
  const auto with = [&](const char* pointer, const nlohmann::ordered_json& value) {
    auto bad = good;
    bad[nlohmann::ordered_json::json_pointer(pointer)] = value;
    return MessageOf(bad.dump());
  };
  EXPECT_EQ(MessageOf(good.dump()), "");
  EXPECT_EQ(MessageOf("{\n  \"format\": }"), "card.json:2:13: must be JSON, whole and readable");
  EXPECT_THAT(MessageOf(good.dump().substr(0, 900)), HasSubstr("card.json:1:"));
  EXPECT_THAT(with("/format", "other"), HasSubstr("format: must be 'windhover-correction'"));
  EXPECT_THAT(with("/pcm/width", 5), HasSubstr("pcm.width: must be 4 or 96 (found '5')"));
  EXPECT_THAT(with("/pcm/stages/1/offset", {1, 2}),
              HasSubstr("card.json: pcm.stages.1.offset: must be 393 numbers (found a list of 2)"));
  EXPECT_THAT(with("/pcm/stages/0/gate/7", nullptr), HasSubstr("pcm.stages.0.gate.7: must be a"));
  EXPECT_THAT(with("/pcm/stages/0/gate/7", 1e30), HasSubstr("pcm.stages.0.gate.7: must be a"));
  EXPECT_THAT(with("/joint_mlp/scale/3", 0), HasSubstr("joint_mlp.scale: must be above 0"));
  EXPECT_THAT(with("/priors/size_sigma", "x"), HasSubstr("priors.size_sigma: must be a number"));
  EXPECT_THAT(with("/extra", 1), HasSubstr("(found 'extra')"));
  EXPECT_THAT(MessageOf("[1e999]"), HasSubstr("card.json"));
  EXPECT_THAT(MessageOf("3"), HasSubstr("the card: must be an object"));
}

TEST(CorrectionCard, FilesAreBoundedAndNamed) {
  const std::string large = test::ScratchFile(std::string((16 << 20) + 1, ' '));
  const InputFile named{"large.json", large, "flight.yaml:3:5"};
  try {
    ReadCorrectionCard(named);
    FAIL() << "a file that is too large was read";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("flight.yaml:3:5: "));
    EXPECT_THAT(error.what(), HasSubstr("must be at most 16777216 bytes (found 16777217)"));
  }
  EXPECT_THROW(ReadCorrectionCard(std::filesystem::path("/nowhere/card.json")), ConfigError);
}

TEST(CorrectionCard, ServesTheMethodsOfAScenario) {
  AircraftConfig config = Config();
  config.estimator.correction = {"card.json", test::ScratchFile(CorrectionCardText(SomeCard())),
                                 "flight.yaml:3:5"};
  for (const std::string method : {"pcm", "pcm_dic", "pcm_dic_star", "joint_mlp"}) {
    EXPECT_NE(MakeRangeEstimator(method, config), nullptr);
  }
  config.estimator.correction.absolute = test::ScratchFile(CorrectionCardText({}), "poor");
  EXPECT_THROW(MakeRangeEstimator("pcm", config), ConfigError);
}

}  // namespace
}  // namespace windhover
