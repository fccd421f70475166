#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "estimator/yolox_detector.h"
#include "learn/detector/evaluation_set.h"
#include "learn/detector/fit_box_noise.h"

namespace windhover {

/// A stereo pair with what it shows and what a detector says of it.
struct TriedPair {
  PairResult result;  ///< What each image shows by itself was found from score 0.01 on.
  std::vector<stereo_box_t> detections;  ///< What the loop would get.
};

/// Runs a detector over pairs of pictures (learn/detector/evaluation_set.h).
/// @param on_pair told how many are done; false stops.
std::vector<TriedPair> TryDetector(YoloxDetector* detector, const Scenario& base,
                                   const PictureConfig& pictures, int n_pairs,
                                   const std::function<bool(int done)>& on_pair);

/// Whether both images show one aircraft, clearly.
bool HasClearTarget(const TriedPair& pair);

/// The detection of the pair's target: the best one whose centre lies within its box in both
/// images; null: missed, or there is no clear target.
const stereo_box_t* DetectionOf(const TriedPair& pair);

/// Errors of all clear targets, for FitBoxNoise().
std::vector<BoxErrorSample> ErrorSamples(const std::vector<TriedPair>& pairs);

/// Precision, recall, errors and false detections.
struct TrialScore {
  struct Bin {
    double from_m, to_m;
    int n = 0, n_found = 0;    ///< Clear targets.
    double centre_px = 0;      ///< Median |error| of x of a box; 0: none was found.
    double difference_px = 0;  ///< Median |error| of the difference of left and right x.
    double bias_px = 0;        ///< Mean error of x.
  };
  /// Of aircraft of some widths, px of the image.
  struct SizeBin {
    WidthRange widths;
    std::optional<double> ap50, ap50_95;
  };
  std::optional<double> ap50, ap50_95;  ///< Of each image for itself.
  std::vector<SizeBin> sizes;           ///< Those that there are.
  std::vector<Bin> bins;                ///< Of ranges with targets; the first has all.
  int n_empty = 0;                      ///< Pairs without a target in either image.
  int n_false = 0;                      ///< Detections in those.
  int n_beside = 0;                     ///< Detections in others that are not of their target.
};

TrialScore ScoreTrial(const std::vector<TriedPair>& pairs);

/// What a detector would find if its least score were another.
struct ScoreChoice {
  double min_score = 0;
  double recall = 0;  ///< Of clear targets.
  int n_false = 0;    ///< In empty pairs.
};

/// For least scores of 0.05, 0.1, … 0.95, of pairs tried with the first or less.
std::vector<ScoreChoice> ScoreChoices(const std::vector<TriedPair>& pairs);

/// The least score from which on nothing is found in empty pairs.
/// @throws std::invalid_argument if there is always something.
double QuietScore(const std::vector<ScoreChoice>& choices);

std::string ScoreChoicesText(const std::vector<ScoreChoice>& choices);

/// As a table for people.
std::string TrialText(const TrialScore& score);

nlohmann::ordered_json TrialJson(const TrialScore& score);

/// The keys of `geometric` that were fitted, in one line.
std::string BoxNoiseText(const GeometricConfig& fitted);

/// Writes both into a detector's card: "box_noise", and the score beside `command` into its
/// provenance. @throws ConfigError as ReadDetectorCard().
void PutIntoCard(const std::filesystem::path& card, const std::string& command,
                 const TrialScore& score, const GeometricConfig& fitted);

/// Writes a detector's least score into its card, the command into its provenance; takes away what
/// was measured with another. @throws ConfigError as ReadDetectorCard().
void PutMinScoreIntoCard(const std::filesystem::path& card, const std::string& command,
                         double min_score);

}  // namespace windhover
