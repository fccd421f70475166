#include "estimator/image_decoding.h"

#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image/image_codecs.h"

namespace windhover {
namespace {

constexpr int kMaxSide_px = 16384;

void Require(bool holds, const image_t& message, const char* what) {
  if (holds) return;
  throw std::runtime_error(fmt::format(
      "image of {} x {} px, {} bytes a row, {} bytes, format {}: {}", message.width, message.height,
      message.row_stride, message.data.size(), message.pixelformat, what));
}

/// The pixels where they are. OpenCV has no read-only view: nobody may write to it.
cv::Mat View(const image_t& message, std::span<const std::uint8_t> bytes, int cv_type,
             int bytes_per_pixel) {
  Require(message.row_stride >= message.width * bytes_per_pixel, message, "rows overlap");
  const auto needed = std::int64_t{message.row_stride} * (message.height - 1) +
                      std::int64_t{message.width} * bytes_per_pixel;
  Require(static_cast<std::int64_t>(bytes.size()) >= needed, message, "data is too short");
  return cv::Mat(message.height, message.width, cv_type, const_cast<std::uint8_t*>(bytes.data()),
                 static_cast<std::size_t>(message.row_stride));
}

cv::Mat Converted(const cv::Mat& image, int conversion) {
  cv::Mat rgb;
  cv::cvtColor(image, rgb, conversion);
  return rgb;
}

}  // namespace

cv::Mat RgbFromMessage(const image_t& message) { return RgbFromMessage(message, message.data); }

cv::Mat RgbFromMessage(const image_t& message, std::span<const std::uint8_t> bytes) {
  Require(message.width > 0 && message.height > 0 && message.width <= kMaxSide_px &&
              message.height <= kMaxSide_px,
          message, "no such size");
  switch (message.pixelformat) {
    case image_t::PIXEL_FORMAT_RGB:
      return View(message, bytes, CV_8UC3, 3);
    case image_t::PIXEL_FORMAT_GRAY:
      return Converted(View(message, bytes, CV_8UC1, 1), cv::COLOR_GRAY2RGB);
    case image_t::PIXEL_FORMAT_BAYER_RGGB:
      // OpenCV names patterns by their second row: its "BG" begins R G.
      return Converted(View(message, bytes, CV_8UC1, 1), cv::COLOR_BayerBG2RGB);
    case image_t::PIXEL_FORMAT_MJPEG: {
      Require(!bytes.empty(), message, "no data");
      const cv::Mat jpeg(1, static_cast<int>(bytes.size()), CV_8UC1,
                         const_cast<std::uint8_t*>(bytes.data()));
      const cv::Mat bgr = Codecs().imdecode(jpeg, cv::IMREAD_COLOR);
      Require(bgr.cols == message.width && bgr.rows == message.height, message,
              "the JPEG inside is broken or of another size");
      return Converted(bgr, cv::COLOR_BGR2RGB);
    }
    default:
      Require(false, message, "unknown pixel format");
      return {};
  }
}

}  // namespace windhover
