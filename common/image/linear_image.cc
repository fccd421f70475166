#include "common/image/linear_image.h"

#include <array>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/image/srgb.h"

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 30;
constexpr std::size_t kMaxPixels = std::size_t{128} << 20;

[[noreturn]] void Fail(const InputFile& file, const std::string& what) {
  throw ConfigError(fmt::format("{}: {} (found '{}')", file.where, what, file.as_given));
}

void CheckFile(const InputFile& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file.absolute, error)) Fail(file, "no such image file");
  const std::uintmax_t bytes = std::filesystem::file_size(file.absolute, error);
  if (error || bytes == 0) Fail(file, "image file is empty or cannot be read");
  if (bytes > kMaxBytes) Fail(file, "image file is larger than 1 GiB");
}

cv::Mat Decode(const InputFile& file) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", /*overwrite=*/1);  // Off by default since 4.5.
  cv::Mat image;
  try {
    image = cv::imread(file.absolute, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception& error) {
    Fail(file, fmt::format("image cannot be decoded: {}", error.err));
  }
  if (image.empty()) Fail(file, "is not an image that can be decoded (PNG, JPEG, HDR, EXR)");
  if (image.channels() != 3) Fail(file, "image must have colour channels");
  if (image.total() > kMaxPixels) Fail(file, "image is larger than 128 Mpx");
  return image;
}

float Sane(float value) { return value > 0 && value < 1e9f ? value : 0; }

// Linear light of every value of an integer image.
std::vector<float> TransferTable(int depth) {
  const int count = depth == CV_8U ? 256 : 65536;
  std::vector<float> table(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    table[static_cast<std::size_t>(i)] = static_cast<float>(LinearFromSrgb(i / (count - 1.0)));
  }
  return table;
}

template <typename Value, typename ToLinear>
void Convert(const cv::Mat& bgr, const ToLinear& to_linear, LinearImage* out) {
  for (int y = 0; y < bgr.rows; ++y) {
    const Value* row = bgr.ptr<Value>(y);
    for (int x = 0; x < bgr.cols; ++x, row += 3) {
      out->pixels.emplace_back(to_linear(row[2]), to_linear(row[1]), to_linear(row[0]));
    }
  }
}

}  // namespace

LinearImage ReadLinearImage(const InputFile& file) {
  CheckFile(file);
  const cv::Mat image = Decode(file);
  LinearImage out{.width_px = image.cols, .height_px = image.rows, .pixels = {}, .is_hdr = false};
  out.pixels.reserve(image.total());
  switch (image.depth()) {
    case CV_8U: {
      const std::vector<float> table = TransferTable(CV_8U);
      Convert<std::uint8_t>(
          image, [&](std::uint8_t v) { return table[v]; }, &out);
      break;
    }
    case CV_16U: {
      const std::vector<float> table = TransferTable(CV_16U);
      Convert<std::uint16_t>(
          image, [&](std::uint16_t v) { return table[v]; }, &out);
      break;
    }
    case CV_32F:
      out.is_hdr = true;
      Convert<float>(image, Sane, &out);
      break;
    default:
      Fail(file, "image must have 8 or 16 bits or floats per channel");
  }
  return out;
}

}  // namespace windhover
