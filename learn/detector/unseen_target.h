#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "learn/detector/detector_trial.h"
#include "learn/method_trial.h"

namespace windhover {

/// Pictures of one kind of target to try a detector on, otherwise as HeldOutPictures() from 4 to
/// 40 m.
PictureConfig TrialPicturesOf(TargetKind kind, std::uint64_t seed);

/// Pictures of it to fine-tune by, as its owner would take them: with the same rig and sensor, but
/// in the surroundings of the training split; four pairs of each place.
PictureConfig TuningPicturesOf(TargetKind kind, std::uint64_t seed);

/// Draws `n_pairs` pairs into a folder that ReadLabelledFolder() reads, images/NNN_{left,right}.png
/// and their labels. @throws std::runtime_error if a file cannot be written.
void WriteLabelledFolder(const Scenario& base, const PictureConfig& pictures, int n_pairs,
                         const std::filesystem::path& folder);

/// Whose boxes distances are of.
enum class BoxSource {
  kBest,      ///< A pair's best detection, whatever it shows: what an aircraft would believe.
  kLabelled,  ///< Its label.
};

/// What each of `methods` says of each pair with a clear target, by scene of `pairs_a_scene`. Pairs
/// do not follow each other in time, so that methods which remember have nothing to.
/// @throws as MakeRangeEstimator.
std::vector<std::vector<TriedFrame>> RangesOn(const std::vector<TriedPair>& pairs,
                                              int pairs_a_scene, BoxSource source,
                                              const Scenario& base,
                                              const std::vector<TrialMethod>& methods);

}  // namespace windhover
