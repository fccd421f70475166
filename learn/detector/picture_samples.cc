#include "learn/detector/picture_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "learn/detector/crop.h"
#include "network/box_network.h"
#include "network/detector_input.h"

namespace windhover {
namespace {

constexpr double kMostHidden = 0.6, kMostOutside = 0.65;
constexpr double kSmallest_px = 8;
constexpr double kCentreError = 0.05, kSizeError = 0.13;  ///< Of the box.
constexpr int kRefinements = 3;                           ///< Of a picture.
constexpr std::size_t kMostMistakes = 2;                  ///< Of a picture with a target.

DetectorSample SeenSample(const LabelledPicture& picture, const InputWindow& window) {
  DetectorSample sample{.rgb = SeenThrough(window, picture.rgb), .box = std::nullopt};
  if (!picture.box) return sample;
  sample.box = window.FromImage(*picture.box);
  return Cropped(sample, 0, 0, window.size, 0).value();
}

// What the first network may have found in the place of `box`.
image_box_t AsFound(image_box_t box, RandomStream* random) {
  const double longer_px = std::max(box.w_px, box.h_px);
  box.x_px += (kCentreError * longer_px + 0.5) * random->Normal();
  box.y_px += (kCentreError * longer_px + 0.5) * random->Normal();
  const double scale = std::exp(kSizeError * random->Normal());
  box.w_px *= scale;
  box.h_px *= scale;
  return box;
}

image_box_t AnyBox(const cv::Mat& rgb, RandomStream* random) {
  image_box_t box{};
  box.w_px = box.h_px = 16 * std::pow(25.0, random->Uniform());
  box.x_px = random->Uniform(0, rgb.cols);
  box.y_px = random->Uniform(0, rgb.rows);
  return box;
}

/// What a first network found in a picture.
struct PlacesInPicture {
  std::optional<image_box_t> of_target;  ///< The best one.
  std::vector<image_box_t> elsewhere;
};

PlacesInPicture Sorted(const LabelledPicture& picture, std::span<const image_box_t> places) {
  PlacesInPicture sorted;
  for (const image_box_t& place : places) {
    if (!picture.box || OverlapOf(place, *picture.box) < kMinOverlapAgain) {
      sorted.elsewhere.push_back(place);
    } else if (!sorted.of_target) {
      sorted.of_target = place;
    }
  }
  return sorted;
}

template <typename AddPicture>
ReplaySource::MakeScene SceneMaker(const Scenario& base, const PictureConfig& pictures,
                                   AddPicture add) {
  return [base, pictures, add](int number) {
    std::vector<DetectorSample> samples;
    PictureScene scene(base, pictures, number);
    for (int i = 0; i < scene.size(); ++i) {
      const LabelledPair pair = scene.Draw(i);
      for (std::size_t eye = 0; eye < pair.eyes.size(); ++eye) {
        RandomStream random(pictures.seed, fmt::format("samples/{}/{}/{}", number, i, eye));
        if (IsClear(pair.eyes[eye])) add(pair.eyes[eye], &random, &samples);
      }
    }
    return samples;
  };
}

}  // namespace

bool IsClear(const LabelledPicture& picture) {
  if (!picture.box) return true;
  return std::max(picture.box->w_px, picture.box->h_px) >= kSmallest_px &&
         picture.occlusion <= kMostHidden && picture.truncation <= kMostOutside;
}

DetectorSample WholeSample(const LabelledPicture& picture) {
  return SeenSample(picture,
                    LetterboxWindow(picture.rgb.size(), {kDetectorWidth_px, kDetectorHeight_px}));
}

FindPlaces PlacesFoundBy(const NetworkModel& first) {
  const auto network = std::make_shared<BoxNetwork>(first, /*batch=*/1);
  return [network](const cv::Mat& rgb) {
    const std::vector<ScoredBox> found = network->FindInWhole({&rgb, 1}, kWorthALook)[0];
    std::vector<image_box_t> places;
    for (const ScoredBox& box : found) places.push_back(box.box);
    return places;
  };
}

std::vector<DetectorSample> RefinementSamples(const LabelledPicture& picture, int n,
                                              std::span<const image_box_t> places,
                                              RandomStream* random) {
  const PlacesInPicture sorted = Sorted(picture, places);
  std::vector<DetectorSample> samples;
  const auto look = [&](const image_box_t& found) {
    const cv::Size size(kRefinementSide_px, kRefinementSide_px);
    return SeenSample(picture, CropWindow(found, kRefinementMargin, size));
  };
  const auto n_shown = static_cast<std::size_t>(picture.box ? n - 1 : 0);
  for (std::size_t i = 0; i < n_shown; ++i) {
    const bool is_found = i == 0 && sorted.of_target;
    samples.push_back(look(is_found ? *sorted.of_target : AsFound(*picture.box, random)));
  }
  const auto add_mistake = [&](const image_box_t& found) {
    DetectorSample sample = look(found);
    if (!sample.box) samples.push_back(std::move(sample));
  };
  const std::size_t most = picture.box ? n_shown + kMostMistakes : static_cast<std::size_t>(n);
  for (const image_box_t& place : sorted.elsewhere) {
    if (samples.size() < most) add_mistake(place);
  }
  for (auto i = samples.size(); i < static_cast<std::size_t>(n); ++i) {
    add_mistake(AnyBox(picture.rgb, random));
  }
  return samples;
}

std::unique_ptr<DetectorSampleSource> MakeDetectionSource(const Scenario& base,
                                                          const PictureConfig& pictures,
                                                          const ReplayConfig& replay) {
  return std::make_unique<ReplaySource>(
      SceneMaker(base, pictures,
                 [](const LabelledPicture& picture, RandomStream*, auto* samples) {
                   samples->push_back(WholeSample(picture));
                 }),
      replay);
}

std::unique_ptr<DetectorSampleSource> MakeRefinementSource(const Scenario& base,
                                                           const PictureConfig& pictures,
                                                           const ReplayConfig& replay,
                                                           FindPlaces find) {
  ReplayConfig crops = replay;
  crops.whole_every = 0;  // They are no parts of pictures.
  const auto add = [find = std::move(find)](const LabelledPicture& picture, RandomStream* random,
                                            auto* samples) {
    const auto places = find ? find(picture.rgb) : std::vector<image_box_t>();
    for (auto& one : RefinementSamples(picture, kRefinements, places, random)) {
      samples->push_back(std::move(one));
    }
  };
  return std::make_unique<ReplaySource>(SceneMaker(base, pictures, add), crops);
}

}  // namespace windhover
