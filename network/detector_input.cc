#include "network/detector_input.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

namespace windhover {
namespace {

constexpr int kGrey = 114;
// Weights of the pixels under a place sum up to these; what is summed fits 16, then 32 bits.
constexpr int kRowBits = 8, kColumnBits = 14;

/// Pixels of a line of the image that one place of the input covers.
struct Taps {
  int first = 0;                       ///< Within the image.
  std::vector<std::uint16_t> weights;  ///< Of `first` and those after it.
  std::uint16_t beyond = 0;            ///< Of grey.
};

/// Whole numbers in the proportions of `shares`, which sum up to 1, that sum up to `total`.
std::vector<std::uint16_t> Rounded(const std::vector<double>& shares, int total) {
  std::vector<std::uint16_t> whole;
  double sum = 0;
  int before = 0;
  for (const double share : shares) {
    sum += share * total;
    const int until = std::clamp(static_cast<int>(std::lround(sum)), before, total);
    whole.push_back(static_cast<std::uint16_t>(until - before));
    before = until;
  }
  whole.back() = static_cast<std::uint16_t>(whole.back() + total - before);
  return whole;
}

/// @param middle of the place, px of the image. @param width that it covers, at least 1 px.
Taps TapsAt(double middle, double width, int n_pixels, int bits) {
  const double from = middle - width / 2 + 0.5, to = from + width;  // Pixel i covers [i, i + 1].
  const double inside_from = std::clamp(from, 0.0, double{1} * n_pixels);
  const double inside_to = std::clamp(to, 0.0, double{1} * n_pixels);
  Taps taps;
  taps.first = std::min(static_cast<int>(inside_from), n_pixels - 1);
  std::vector<double> shares;
  for (int i = taps.first; i < inside_to; ++i) {
    const double covered = std::min(inside_to, i + 1.0) - std::max(inside_from, double{1} * i);
    shares.push_back(std::max(0.0, covered) / width);
  }
  shares.push_back(1 - (inside_to - inside_from) / width);
  taps.weights = Rounded(shares, 1 << bits);
  taps.beyond = taps.weights.back();
  taps.weights.pop_back();
  return taps;
}

std::vector<Taps> AllTaps(double first_px, double scale, int n, int n_pixels, int bits) {
  std::vector<Taps> all;
  for (int i = 0; i < n; ++i) {
    const double middle = first_px + (i + 0.5) * scale;
    all.push_back(TapsAt(middle, std::max(1.0, scale), n_pixels, bits));
  }
  return all;
}

/// `n` values that start at column `first` of the rows under `taps`, summed with their weights.
void SumRows(const cv::Mat& rgb, const Taps& taps, int first, int n, std::uint16_t* sums) {
  std::fill_n(sums, n, static_cast<std::uint16_t>(kGrey * taps.beyond));
  for (std::size_t k = 0; k < taps.weights.size(); ++k) {
    const std::uint8_t* row = rgb.ptr(taps.first + static_cast<int>(k)) + 3 * first;
    const unsigned weight = taps.weights[k];
    for (int i = 0; i < n; ++i) sums[i] = static_cast<std::uint16_t>(sums[i] + weight * row[i]);
  }
}

/// One row of what is seen. @param sums of the rows under it, of which it needs those in `columns`.
void SumColumns(const std::uint16_t* sums, const std::vector<Taps>& columns, int first,
                std::uint8_t* seen) {
  constexpr int kBits = kRowBits + kColumnBits;
  for (const Taps& taps : columns) {
    const unsigned grey = (1U << (kBits - 1)) + (unsigned{kGrey} << kRowBits) * taps.beyond;
    unsigned red = grey, green = grey, blue = grey;
    const std::uint16_t* under = sums + 3 * (taps.first - first);
    for (const unsigned weight : taps.weights) {
      red += weight * under[0];
      green += weight * under[1];
      blue += weight * under[2];
      under += 3;
    }
    *seen++ = static_cast<std::uint8_t>(red >> kBits);
    *seen++ = static_cast<std::uint8_t>(green >> kBits);
    *seen++ = static_cast<std::uint8_t>(blue >> kBits);
  }
}

}  // namespace

image_box_t InputWindow::ToImage(const image_box_t& box) const {
  image_box_t in_image{};
  in_image.x_px = left_px + (box.x_px + 0.5) * scale;
  in_image.y_px = top_px + (box.y_px + 0.5) * scale;
  in_image.w_px = box.w_px * scale;
  in_image.h_px = box.h_px * scale;
  return in_image;
}

image_box_t InputWindow::FromImage(const image_box_t& box) const {
  image_box_t in_input{};
  in_input.x_px = (box.x_px - left_px) / scale - 0.5;
  in_input.y_px = (box.y_px - top_px) / scale - 0.5;
  in_input.w_px = box.w_px / scale;
  in_input.h_px = box.h_px / scale;
  return in_input;
}

int InputWindow::Pixels(double length_px) const {
  return std::max(1, static_cast<int>(std::lround(length_px / scale)));
}

InputWindow LetterboxWindow(cv::Size image, cv::Size input) {
  return {.scale = std::max(double{1} * image.width / input.width,
                            double{1} * image.height / input.height),
          .size = input};
}

InputWindow WindowAround(const image_box_t& box, double scale, cv::Size size) {
  return {.left_px = box.x_px - scale * size.width / 2,
          .top_px = box.y_px - scale * size.height / 2,
          .scale = scale,
          .size = size};
}

InputWindow ReducedWindow(const image_box_t& box, double longest_px) {
  InputWindow reduced;
  reduced.scale = std::max(1.0, std::max(box.w_px, box.h_px) / longest_px);
  const cv::Size size(reduced.Pixels(box.w_px), reduced.Pixels(box.h_px));
  return WindowAround(box, reduced.scale, size);
}

InputWindow CropWindow(const image_box_t& box, double margin, cv::Size input) {
  const double side = margin * std::max({box.w_px, box.h_px, 1.0});
  return WindowAround(box, side / std::max(input.width, input.height), input);
}

cv::Mat SeenThrough(const InputWindow& window, const cv::Mat& rgb) {
  if (rgb.type() != CV_8UC3 || rgb.empty()) {
    throw std::invalid_argument(
        fmt::format("a network needs an 8-bit RGB image (found {} x {} px of {} channels)",
                    rgb.cols, rgb.rows, rgb.channels()));
  }
  const auto rows = AllTaps(window.top_px, window.scale, window.size.height, rgb.rows, kRowBits);
  const auto columns =
      AllTaps(window.left_px, window.scale, window.size.width, rgb.cols, kColumnBits);
  const int first = columns.front().first;
  const int last = columns.back().first + static_cast<int>(columns.back().weights.size());
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(std::max(0, last - first)) * 3);
  cv::Mat seen(window.size, CV_8UC3);
  for (int y = 0; y < window.size.height; ++y) {
    const Taps& taps = rows[static_cast<std::size_t>(y)];
    SumRows(rgb, taps, first, static_cast<int>(sums.size()), sums.data());
    SumColumns(sums.data(), columns, first, seen.ptr(y));
  }
  return seen;
}

void ToPlanes(const cv::Mat& rgb, std::span<float> planes) {
  const auto n = static_cast<std::size_t>(rgb.rows) * static_cast<std::size_t>(rgb.cols);
  if (rgb.type() != CV_8UC3 || planes.size() != 3 * n) {
    throw std::invalid_argument("planes must be three floats for each pixel of an 8-bit image");
  }
  float* plane = planes.data();
  for (int y = 0; y < rgb.rows; ++y) {
    const std::uint8_t* row = rgb.ptr(y);
    for (int x = 0; x < rgb.cols; ++x, ++plane, row += 3) {
      plane[0] = static_cast<float>(row[0]) / 255;
      plane[n] = static_cast<float>(row[1]) / 255;
      plane[2 * n] = static_cast<float>(row[2]) / 255;
    }
  }
}

}  // namespace windhover
