#include "common/image/frame_encoding.h"

#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image/image_codecs.h"

namespace windhover {
namespace {

// A view; OpenCV has no read-only one.
cv::Mat MatOf(const RgbImage& image) {
  return cv::Mat(image.height_px, image.width_px, CV_8UC3,
                 const_cast<std::uint8_t*>(image.pixels.data()));
}

std::vector<std::uint8_t> Mosaic(const RgbImage& image) {
  std::vector<std::uint8_t> mosaic;
  mosaic.reserve(image.pixels.size() / 3);
  for (int y = 0; y < image.height_px; ++y) {
    const std::uint8_t* row = image.Row(y);
    // Red and green take turns in even rows, green and blue in odd ones.
    for (int x = 0; x < image.width_px; ++x) mosaic.push_back(row[3 * x + x % 2 + y % 2]);
  }
  return mosaic;
}

std::vector<std::uint8_t> Green(const RgbImage& image) {
  std::vector<std::uint8_t> green(image.pixels.size() / 3);
  for (std::size_t i = 0; i < green.size(); ++i) green[i] = image.pixels[3 * i + 1];
  return green;
}

std::vector<std::uint8_t> Jpeg(const RgbImage& image, const FrameFormat& format) {
  cv::Mat coded;
  if (format.is_grey) {
    cv::extractChannel(MatOf(image), coded, 1);
  } else {
    cv::cvtColor(MatOf(image), coded, cv::COLOR_RGB2BGR);
  }
  std::vector<std::uint8_t> jpeg;
  if (!Codecs().imencode(".jpg", coded, jpeg, {cv::IMWRITE_JPEG_QUALITY, format.jpeg_quality})) {
    throw std::runtime_error("a frame could not be encoded as JPEG");
  }
  return jpeg;
}

}  // namespace

image_t EncodeFrame(RgbImage&& image, Utime utime, const FrameFormat& format) {
  if (!format.is_bayer && !format.is_grey && format.jpeg_quality == 0) {
    return MessageFromImage(std::move(image), utime);
  }
  image_t message{};
  message.utime = utime;
  message.width = image.width_px;
  message.height = image.height_px;
  if (format.is_bayer) {
    message.row_stride = image.width_px;
    message.pixelformat = image_t::PIXEL_FORMAT_BAYER_RGGB;
    message.data = Mosaic(image);
  } else if (format.jpeg_quality > 0) {
    message.pixelformat = image_t::PIXEL_FORMAT_MJPEG;
    message.data = Jpeg(image, format);
  } else {
    message.row_stride = image.width_px;
    message.pixelformat = image_t::PIXEL_FORMAT_GRAY;
    message.data = Green(image);
  }
  message.size = static_cast<std::int32_t>(message.data.size());
  return message;
}

RgbImage AsReceived(RgbImage image, const FrameFormat& format) {
  if (format.is_bayer) {
    std::vector<std::uint8_t> mosaic = Mosaic(image);
    // OpenCV names patterns by their second row: its "BG" begins R G.
    cv::cvtColor(cv::Mat(image.height_px, image.width_px, CV_8UC1, mosaic.data()), MatOf(image),
                 cv::COLOR_BayerBG2RGB);
  } else if (format.jpeg_quality > 0) {
    const cv::Mat bgr = Codecs().imdecode(Jpeg(image, format), cv::IMREAD_COLOR);
    cv::cvtColor(bgr, MatOf(image), cv::COLOR_BGR2RGB);
  } else if (format.is_grey) {
    std::vector<std::uint8_t> green = Green(image);
    cv::cvtColor(cv::Mat(image.height_px, image.width_px, CV_8UC1, green.data()), MatOf(image),
                 cv::COLOR_GRAY2RGB);
  }
  return image;
}

}  // namespace windhover
