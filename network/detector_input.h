#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "lcmtypes/image_box_t.hpp"

namespace windhover {

/// What part of an image a network sees, and at which size: a rectangle of `size` squares with
/// sides of `scale` px of the image. It may reach beyond the image.
struct InputWindow {
  double left_px = -0.5, top_px = -0.5;  ///< Its corner; -0.5 is the image's own.
  double scale = 1;                      ///< px of the image to one px of the input.
  cv::Size size;                         ///< px of the input.

  /// A box of the input, in px of the image, and the reverse.
  image_box_t ToImage(const image_box_t& box) const;
  image_box_t FromImage(const image_box_t& box) const;

  /// Of the input, that `length_px` of the image takes, at least one.
  int Pixels(double length_px) const;
};

/// The whole image, as large as fits the input, in its upper left corner (a letterbox).
InputWindow LetterboxWindow(cv::Size image, cv::Size input);

/// `size` px of the input with the middle of `box` in theirs.
InputWindow WindowAround(const image_box_t& box, double scale, cv::Size size);

/// `box` alone, pixel by pixel or, if its longer side has more than `longest_px`, reduced to those.
InputWindow ReducedWindow(const image_box_t& box, double longest_px);

/// A square around `box` whose side is `margin` times the box's longer one.
InputWindow CropWindow(const image_box_t& box, double margin, cv::Size input);

/// What the network sees. Every pixel is the mean of the image over a square around its place, one
/// pixel wide or, if that is more, `scale`: the area of what it covers in a reduction, linear
/// interpolation in an enlargement. Beyond the image all is grey (114). In whole numbers: the same
/// bits everywhere.
/// @throws std::invalid_argument unless `rgb` is 8-bit RGB with at least one pixel.
cv::Mat SeenThrough(const InputWindow& window, const cv::Mat& rgb);

/// The values that a network takes: red, then green, then blue, rows from the top, 0..1.
/// @throws std::invalid_argument unless `planes` has three values for each pixel of `rgb`.
void ToPlanes(const cv::Mat& rgb, std::span<float> planes);

}  // namespace windhover
