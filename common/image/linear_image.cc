#include "common/image/linear_image.h"

#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "common/image/image_codecs.h"
#include "common/image/image_header.h"
#include "common/image/srgb.h"
#include "common/process/isolated.h"

namespace windhover {
namespace {

[[noreturn]] void Fail(const InputFile& file, const std::string& what) {
  throw ConfigError(fmt::format("{}: {} (found '{}')", file.where, what, file.as_given));
}

// Sizes and type of a matrix, then its rows.
struct MatHeader {
  int rows, cols, type;
};

std::string DecodeHere(const std::string& file) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", /*overwrite=*/1);  // Off by default since 4.5.
  cv::Mat image;
  try {
    image = Codecs().imread(file, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
  } catch (const cv::Exception& error) {
    throw ConfigError(fmt::format("image cannot be decoded: {}", error.err));
  }
  if (image.empty()) throw ConfigError("is not an image that can be decoded (PNG, JPEG, HDR, EXR)");
  if (image.channels() != 3) throw ConfigError("image must have colour channels");
  const MatHeader header{image.rows, image.cols, image.type()};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  for (int y = 0; y < image.rows; ++y) {
    bytes.append(image.ptr<char>(y), static_cast<std::size_t>(image.cols) * image.elemSize());
  }
  return bytes;
}

// In a process of its own: decoders crash on some broken files. `bytes` holds the pixels.
cv::Mat Decode(const InputFile& file, std::string* bytes) {
  MatHeader header{};
  try {
    CheckImageFile(file.absolute);
    Codecs();
    *bytes = RunIsolated(std::filesystem::file_size(file.absolute),
                         [&] { return DecodeHere(file.absolute); });
  } catch (const ConfigError& error) {
    Fail(file, error.what());
  }
  std::memcpy(&header, bytes->data(), sizeof header);
  return cv::Mat(header.rows, header.cols, header.type, bytes->data() + sizeof header);
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
  std::string bytes;
  const cv::Mat image = Decode(file, &bytes);
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
