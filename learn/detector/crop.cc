#include "learn/detector/crop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace windhover {
namespace {

constexpr int kTries = 8;
constexpr double kLeastShare = 0.6;

/// One axis of a box: its middle and its length.
struct Span {
  double middle, length;
};

// The part of `span` within n pixels, the first of which has its middle at 0.
Span CutAt(const Span& span, int n) {
  const double low = std::max(span.middle - span.length / 2, -0.5);
  const double high = std::min(span.middle + span.length / 2, n - 0.5);
  return {(low + high) / 2, std::max(high - low, 0.0)};
}

// Where a window of n pixels may begin on an axis of n_all to show a span, a part of it perhaps
// outside.
int PlaceFor(const Span& span, int n, int n_all, RandomStream* random) {
  const double slack = 0.3 * span.length;
  const double low = span.middle + span.length / 2 - n - slack;
  const double high = span.middle - span.length / 2 + slack;
  const double drawn = low < high ? random->Uniform(low, high) : (low + high) / 2;
  return std::clamp(static_cast<int>(std::lround(drawn)), 0, n_all - n);
}

int AnyPlace(int n, int n_all, RandomStream* random) {
  return static_cast<int>(random->Uniform(0, n_all - n + 1));
}

// Of red, green, blue and 1: mixed with grey to `1 - saturation`, stretched about middle grey.
cv::Matx34f ColourMix(RandomStream* random) {
  const double brightness = std::exp(0.18 * random->Normal());
  const double contrast = std::exp(0.15 * random->Normal());
  const double saturation = random->Uniform() < 0.06 ? 0 : random->Uniform(0.5, 1.4);
  constexpr std::array kLuma = {0.299, 0.587, 0.114};
  cv::Matx34f mix;
  for (int i = 0; i < 3; ++i) {
    const double gain = brightness * contrast * std::exp(0.07 * random->Normal());
    for (int j = 0; j < 3; ++j) {
      const double share =
          (1 - saturation) * kLuma[static_cast<std::size_t>(j)] + (i == j ? saturation : 0);
      mix(i, j) = static_cast<float>(gain * share);
    }
    mix(i, 3) = static_cast<float>(110 * brightness * (1 - contrast));
  }
  return mix;
}

}  // namespace

std::optional<DetectorSample> Cropped(const DetectorSample& sample, int left_px, int top_px,
                                      cv::Size size, double least_share) {
  DetectorSample crop{.rgb = sample.rgb(cv::Rect({left_px, top_px}, size)), .box = std::nullopt};
  if (!sample.box) return crop;
  const image_box_t& box = *sample.box;
  const Span x = CutAt({box.x_px - left_px, box.w_px}, size.width);
  const Span y = CutAt({box.y_px - top_px, box.h_px}, size.height);
  if (x.length <= 0 || y.length <= 0) return crop;
  if (x.length * y.length < least_share * box.w_px * box.h_px) return std::nullopt;
  crop.box = image_box_t{};
  crop.box->x_px = x.middle;
  crop.box->y_px = y.middle;
  crop.box->w_px = x.length;
  crop.box->h_px = y.length;
  return crop;
}

std::optional<DetectorSample> RandomCrop(const DetectorSample& sample, cv::Size size,
                                         bool shows_box, RandomStream* random) {
  if (shows_box && !sample.box) return std::nullopt;
  for (int i = 0; i < kTries; ++i) {
    int left_px = 0, top_px = 0;
    if (shows_box) {
      const image_box_t& box = *sample.box;
      left_px = PlaceFor({box.x_px, box.w_px}, size.width, sample.rgb.cols, random);
      top_px = PlaceFor({box.y_px, box.h_px}, size.height, sample.rgb.rows, random);
    } else {
      left_px = AnyPlace(size.width, sample.rgb.cols, random);
      top_px = AnyPlace(size.height, sample.rgb.rows, random);
    }
    auto crop = Cropped(sample, left_px, top_px, size, kLeastShare);
    if (crop && crop->box.has_value() == shows_box) return crop;
  }
  return std::nullopt;
}

DetectorSample Mirrored(const DetectorSample& sample) {
  DetectorSample mirrored{.rgb = {}, .box = sample.box};
  cv::flip(sample.rgb, mirrored.rgb, /*about the vertical=*/1);
  if (mirrored.box) mirrored.box->x_px = sample.rgb.cols - 1 - mirrored.box->x_px;
  return mirrored;
}

DetectorSample Varied(DetectorSample sample, RandomStream* random) {
  if (random->Uniform() < 0.5) sample = Mirrored(sample);
  cv::Mat varied;
  cv::transform(sample.rgb, varied, ColourMix(random));
  if (random->Uniform() < 0.15) {
    cv::GaussianBlur(varied, varied, {5, 5}, random->Uniform(0.3, 1.0));
  }
  sample.rgb = varied;
  return sample;
}

}  // namespace windhover
