#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "estimator/fitted_priors.h"
#include "estimator/joint_mlp.h"
#include "estimator/pcm.h"

namespace windhover {

/// What was learned of a kind of rig and target: the file of `estimator.correction`.
struct CorrectionCard {
  std::optional<FittedPriors> priors;
  std::optional<PcmStages> pcm;
  std::optional<JointMlp> joint_mlp;
  /// For people: command, seed, data, recipe and scores.
  nlohmann::ordered_json provenance = nlohmann::ordered_json::object();
};

/// The text of a card: JSON with "format": "windhover-correction". ParseCorrectionCard() gives
/// the same card back, bit by bit.
std::string CorrectionCardText(const CorrectionCard& card);

/// @throws ConfigError `NAME:LINE:COLUMN: …` where it is no JSON, `NAME: KEY: must be …` where it
/// is no card: sections that are unknown or of the wrong shape, numbers that are not finite.
CorrectionCard ParseCorrectionCard(const std::string& text, const std::string& name);

/// Reads a card of at most 16 MiB.
/// @throws ConfigError as above, or if the file is larger or cannot be read.
CorrectionCard ReadCorrectionCard(const std::filesystem::path& file);

/// The card of a scenario; its mistakes say where the scenario names it.
CorrectionCard ReadCorrectionCard(const InputFile& file);

}  // namespace windhover
