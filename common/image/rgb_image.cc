#include "common/image/rgb_image.h"

#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "common/image/image_file.h"

namespace windhover {

image_t MessageFromImage(RgbImage&& image, Utime utime) {
  image_t message{};
  message.utime = utime;
  message.width = image.width_px;
  message.height = image.height_px;
  message.row_stride = image.width_px * 3;
  message.pixelformat = image_t::PIXEL_FORMAT_RGB;
  message.size = static_cast<std::int32_t>(image.pixels.size());
  message.data = std::move(image.pixels);
  return message;
}

RgbImage ImageFromMessage(const image_t& message) {
  if (message.pixelformat != image_t::PIXEL_FORMAT_RGB) {
    throw std::runtime_error(
        fmt::format("image_t: pixel format {} is not RGB", message.pixelformat));
  }
  const std::int64_t width = message.width, height = message.height, stride = message.row_stride;
  if (width <= 0 || height <= 0 || stride < width * 3 ||
      stride * height > static_cast<std::int64_t>(message.data.size())) {
    throw std::runtime_error(fmt::format("image_t: {}x{} px with stride {} do not fit {} bytes",
                                         width, height, stride, message.data.size()));
  }
  RgbImage image(message.width, message.height);
  for (int y = 0; y < image.height_px; ++y) {
    std::memcpy(image.Row(y), message.data.data() + y * stride,
                static_cast<std::size_t>(width) * 3);
  }
  return image;
}

void WriteImage(const RgbImage& image, const std::filesystem::path& file) {
  const cv::Mat rgb(image.height_px, image.width_px, CV_8UC3,
                    const_cast<std::uint8_t*>(image.pixels.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  WriteImageFile(bgr, file);
}

}  // namespace windhover
