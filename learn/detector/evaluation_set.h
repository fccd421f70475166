#pragma once

#include <array>
#include <functional>
#include <vector>

#include "learn/detector/average_precision.h"
#include "learn/detector/picture_scene.h"

namespace windhover {

/// Pictures to measure a detector by: of surroundings, paths and rigs that no training sees, with
/// the rig's vibration and bending and all of the sensor (model emva1288). M200 and P600 between
/// `nearest_m` and `farthest_m`, whole and upright as they fly, before nothing but the
/// surroundings.
PictureConfig HeldOutPictures(std::uint64_t seed, double nearest_m, double farthest_m);

/// The same without an aircraft; with distractors (PictureConfig::most_distractors) if asked for.
PictureConfig EmptyPictures(std::uint64_t seed, int most_distractors);

/// What a detector finds in both images of a pair.
using FoundInPair = std::array<std::vector<ScoredBox>, 2>;

/// A pair of which everything is known.
struct PairResult {
  std::array<ImageResult, 2> eyes;  ///< Left, right.
  TargetKind kind{};
};

/// Draws `n_pairs` pairs and shows each to `detect` (8-bit RGB, left and right), which is called
/// by one thread at a time; in order, whatever the number of threads that draw.
/// `on_progress(done)` says whether to go on.
/// @throws ConfigError as PictureScene.
std::vector<PairResult> ShowPictures(
    const Scenario& base, const PictureConfig& pictures, int n_pairs, int threads,
    const std::function<FoundInPair(const cv::Mat& left, const cv::Mat& right)>& detect,
    const std::function<bool(int done)>& on_progress);

}  // namespace windhover
