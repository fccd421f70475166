#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "common/config/fields.h"
#include "network/network_file.h"

namespace windhover {

/// What was learned of a detector: the file of `estimator.detector_model`, JSON with "format":
/// "windhover-detector". Weights are in .onnx files beside it.
struct DetectorCard {
  struct Weights {
    std::string onnx;    ///< Name of a file in the card's folder.
    std::string sha256;  ///< Of that file.
  };

  std::string network;             ///< What `estimator.detector` calls it.
  Weights detector;                ///< Sees the whole image.
  double min_score = 0.3;          ///< What scores less is no aircraft.
  std::optional<Weights> refiner;  ///< Sees a square around what the detector found, ...
  double refiner_margin = 1.6;     ///< ... this many times the box's longer side.
  /// How its boxes err (rig/fitted_box_noise.h), once that was fitted; else null.
  nlohmann::ordered_json box_noise;
  /// For people: command, seed, data, recipe and scores.
  nlohmann::ordered_json provenance = nlohmann::ordered_json::object();
};

std::string DetectorCardText(const DetectorCard& card);

/// @throws ConfigError as ParseCardJson() and CardNode do.
DetectorCard ParseDetectorCard(const std::string& text, const std::string& name);

/// Reads a card of at most 1 MiB.
DetectorCard ReadDetectorCard(const std::filesystem::path& file);

/// The network of a card that lies in `folder`.
/// @throws ConfigError as ReadNetwork(), or if the file is not the one that the card speaks of, or
/// does not give boxes: 6 numbers for each cell of grids over the image.
NetworkModel ReadWeights(const DetectorCard::Weights& weights, const std::filesystem::path& folder);

}  // namespace windhover
