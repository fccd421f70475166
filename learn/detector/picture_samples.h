#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "learn/detector/detector_sample.h"
#include "learn/detector/picture_scene.h"
#include "learn/detector/replay_source.h"
#include "network/network_file.h"

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

/// Where a first network takes something for an aircraft: boxes, px of the picture, best first.
using FindPlaces = std::function<std::vector<image_box_t>(const cv::Mat& rgb)>;

/// Those that score at least 0.05, eight at most.
/// @throws std::runtime_error if no engine can run the network.
FindPlaces PlacesFoundBy(const NetworkModel& first);

/// What the second network gets around what the first found: around the target's box, displaced
/// and scaled as that network errs (centre: 5 % of the size, size: 13 %, one standard deviation),
/// or, once, as it did err; and around up to two places that it took for the target, or else once
/// around a place of any size; none of these shows the target. Without a target, `n` such places.
/// @param places what the first network found in the picture.
/// @return at most `n` + 1 of them.
std::vector<DetectorSample> RefinementSamples(const LabelledPicture& picture, int n,
                                              std::span<const image_box_t> places,
                                              RandomStream* random);

/// Endless training for the first network: crops of `replay.size` of the whole pictures, at most
/// kDetectorWidth_px × kDetectorHeight_px.
std::unique_ptr<DetectorSampleSource> MakeDetectionSource(const Scenario& base,
                                                          const PictureConfig& pictures,
                                                          const ReplayConfig& replay);

/// Endless training for the second network; `replay.size` is its input's.
/// @param find what errs as the first network does; may be nothing.
std::unique_ptr<DetectorSampleSource> MakeRefinementSource(const Scenario& base,
                                                           const PictureConfig& pictures,
                                                           const ReplayConfig& replay,
                                                           FindPlaces find);

}  // namespace windhover
