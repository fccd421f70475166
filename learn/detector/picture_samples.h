#pragma once

#include <memory>
#include <vector>

#include "learn/detector/detector_sample.h"
#include "learn/detector/picture_scene.h"
#include "learn/detector/replay_source.h"

namespace windhover {

/// What the first network sees of an image.
inline constexpr int kDetectorWidth_px = 352, kDetectorHeight_px = 192;

/// What the second network sees: a square around what the first one found, this many times the
/// longer side of its box, as this many px.
inline constexpr double kRefinementMargin = 1.6;
inline constexpr int kRefinementSide_px = 128;

/// Whether a picture can teach: most of the target is to be seen, and it is not tiny; or nothing.
bool IsClear(const LabelledPicture& picture);

/// The whole picture as the first network gets it.
DetectorSample WholeSample(const LabelledPicture& picture);

/// What the second network gets around what the first found: around the target's box, displaced
/// and scaled as that network errs (centre: 7 % of the size, size: 15 %, one standard deviation),
/// and once around a place of any size that shows something else, unless that shows the target.
/// Without a target, `n` such places.
/// @return at most `n` of them.
std::vector<DetectorSample> RefinementSamples(const LabelledPicture& picture, int n,
                                              RandomStream* random);

/// Endless training for the first network: crops of `replay.size` of the whole pictures, at most
/// kDetectorWidth_px × kDetectorHeight_px.
std::unique_ptr<DetectorSampleSource> MakeDetectionSource(const Scenario& base,
                                                          const PictureConfig& pictures,
                                                          const ReplayConfig& replay);

/// Endless training for the second network; `replay.size` is its input's.
std::unique_ptr<DetectorSampleSource> MakeRefinementSource(const Scenario& base,
                                                           const PictureConfig& pictures,
                                                           const ReplayConfig& replay);

}  // namespace windhover
