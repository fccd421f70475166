#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "estimator/correction_card.h"
#include "learn/stereo_tuple.h"
#include "learn/train_joint_mlp.h"
#include "learn/train_pcm.h"

namespace windhover {

/// Tuples as corrections take them; those without rays are left out.
std::vector<PcmSample> SamplesOf(std::span<const StereoTuple> tuples, const StereoRig& rig);

struct SampleSplits {
  std::vector<PcmSample> train, val, test;
};
SampleSplits SamplesOf(const TupleSplits& tuples, const StereoRig& rig);

struct CardPlan {
  StereoRig rig;
  TupleSplits tuples;
  PcmRecipe pcm;
  JointMlpRecipe joint_mlp;
  std::optional<CorrectionCard> start;  ///< Its pcm is what training goes on from.
  std::filesystem::path state_file;     ///< Where an interrupted training is kept.
  bool resume = false;                  ///< Goes on from state_file.
  nlohmann::ordered_json provenance;    ///< Command and data; recipe and scores are added.
};

enum class TrainingEnd { kFinished, kDiverged, kInterrupted };

struct TrainedCard {
  CorrectionCard card;
  std::vector<PcmCurvePoint> curve;
  TrainingEnd end = TrainingEnd::kFinished;
};

/// Trains every section of a card: position corrections, the joint MLP, and priors where there
/// are flights enough. The same plan
/// gives the same card, interrupted or not. A training that diverges ends with the best so far.
/// @param on_epoch told after each epoch; false interrupts: state_file is written.
/// @throws ConfigError if state_file is asked for and is none of this training, or `start` does
/// not fit.
TrainedCard TrainCard(const CardPlan& plan,
                      const std::function<bool(int done, int total)>& on_epoch);

/// Errors over epochs as the content of an .svg file.
std::string CurveSvg(const std::vector<PcmCurvePoint>& curve);

/// The scores in a card's provenance as a table for a terminal.
std::string ScoresText(const CorrectionCard& card);

}  // namespace windhover
