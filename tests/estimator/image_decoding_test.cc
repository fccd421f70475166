#include "estimator/image_decoding.h"

#include <ostream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace windhover {
namespace {

using ::testing::HasSubstr;

image_t Message(int width, int height, int row_stride, int format, std::vector<std::uint8_t> data) {
  image_t message{};
  message.width = width;
  message.height = height;
  message.row_stride = row_stride;
  message.pixelformat = format;
  message.size = static_cast<int>(data.size());
  message.data = std::move(data);
  return message;
}

TEST(RgbFromMessage, ReadsRowsWithPadding) {
  const auto message =
      Message(2, 2, 8, image_t::PIXEL_FORMAT_RGB, {1, 2, 3, 4, 5, 6, 0, 0, 7, 8, 9, 10, 11, 12});
  const cv::Mat rgb = RgbFromMessage(message);
  EXPECT_EQ(rgb.at<cv::Vec3b>(0, 1), cv::Vec3b(4, 5, 6));
  EXPECT_EQ(rgb.at<cv::Vec3b>(1, 0), cv::Vec3b(7, 8, 9));
  EXPECT_EQ(rgb.data, message.data.data()) << "RGB needs no copy";
}

TEST(RgbFromMessage, ReadsGrayAndBayer) {
  const auto gray = Message(2, 1, 2, image_t::PIXEL_FORMAT_GRAY, {10, 20});
  EXPECT_EQ(RgbFromMessage(gray).at<cv::Vec3b>(0, 1), cv::Vec3b(20, 20, 20));
  // A red scene: only the R sites (even row, even column) of an RGGB sensor see light.
  std::vector<std::uint8_t> mosaic(64, 0);
  for (int y = 0; y < 8; y += 2) {
    for (int x = 0; x < 8; x += 2) mosaic[static_cast<std::size_t>(8 * y + x)] = 200;
  }
  const auto bayer = Message(8, 8, 8, image_t::PIXEL_FORMAT_BAYER_RGGB, mosaic);
  EXPECT_EQ(RgbFromMessage(bayer).at<cv::Vec3b>(4, 4), cv::Vec3b(200, 0, 0));
}

TEST(RgbFromMessage, ReadsJpeg) {
  const cv::Mat red_bgr(16, 16, CV_8UC3, cv::Scalar(0, 0, 255));
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", red_bgr, jpeg);
  const cv::Mat rgb = RgbFromMessage(Message(16, 16, 0, image_t::PIXEL_FORMAT_MJPEG, jpeg));
  EXPECT_GT(rgb.at<cv::Vec3b>(8, 8)[0], 250);  // A few steps of JPEG's quantisation.
  EXPECT_LT(rgb.at<cv::Vec3b>(8, 8)[2], 5);
}

struct BadImage {
  image_t message;
  const char* what;

  friend std::ostream& operator<<(std::ostream& out, const BadImage& bad) {
    return out << bad.message.width << " x " << bad.message.height << ": " << bad.what;
  }
};

class BadImages : public ::testing::TestWithParam<BadImage> {};

TEST_P(BadImages, AreRefusedWithTheReason) {
  try {
    RgbFromMessage(GetParam().message);
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(GetParam().what));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Images, BadImages,
    ::testing::Values(
        BadImage{Message(0, 2, 6, image_t::PIXEL_FORMAT_RGB, {}), "no such size"},
        BadImage{Message(2, -1, 6, image_t::PIXEL_FORMAT_RGB, {}), "no such size"},
        BadImage{Message(1 << 30, 1 << 30, 6, image_t::PIXEL_FORMAT_RGB, {}), "no such size"},
        BadImage{Message(2, 2, 5, image_t::PIXEL_FORMAT_RGB, std::vector<std::uint8_t>(12)),
                 "rows overlap"},
        BadImage{Message(2, 2, 6, image_t::PIXEL_FORMAT_RGB, std::vector<std::uint8_t>(11)),
                 "too short"},
        BadImage{Message(2, 2, 6, image_t::PIXEL_FORMAT_MJPEG, {1, 2, 3}), "JPEG inside is broken"},
        BadImage{Message(2, 2, 6, 4711, std::vector<std::uint8_t>(12)), "unknown pixel format"}));

}  // namespace
}  // namespace windhover
