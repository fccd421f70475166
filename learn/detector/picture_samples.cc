#include "learn/detector/picture_samples.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "learn/detector/crop.h"
#include "network/detector_input.h"

namespace windhover {
namespace {

constexpr double kMostHidden = 0.6, kMostOutside = 0.65;
constexpr double kSmallest_px = 8;
constexpr double kCentreError = 0.07, kSizeError = 0.15;  ///< Of the box.
constexpr int kRefinements = 3;                           ///< Of a picture.

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

std::vector<DetectorSample> RefinementSamples(const LabelledPicture& picture, int n,
                                              RandomStream* random) {
  std::vector<DetectorSample> samples;
  const cv::Size size(kRefinementSide_px, kRefinementSide_px);
  for (int i = 0; i < n; ++i) {
    const bool shows_box = picture.box && i + 1 < n;
    const image_box_t found =
        shows_box ? AsFound(*picture.box, random) : AnyBox(picture.rgb, random);
    DetectorSample sample = SeenSample(picture, CropWindow(found, kRefinementMargin, size));
    if (shows_box || !sample.box) samples.push_back(std::move(sample));
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
                                                           const ReplayConfig& replay) {
  ReplayConfig crops = replay;
  crops.whole_every = 0;  // They are no parts of pictures.
  return std::make_unique<ReplaySource>(
      SceneMaker(base, pictures,
                 [](const LabelledPicture& picture, RandomStream* random, auto* samples) {
                   for (auto& one : RefinementSamples(picture, kRefinements, random)) {
                     samples->push_back(std::move(one));
                   }
                 }),
      crops);
}

}  // namespace windhover
