#include "network/detector_input.h"

#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "common/random/random_stream.h"
#include "tests/support/image_box.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;

cv::Mat RandomImage(int width, int height) {
  RandomStream stream(1, "image");
  cv::Mat image(height, width, CV_8UC3);
  for (int i = 0; i < 3 * width * height; ++i) {
    image.data[i] = static_cast<std::uint8_t>(256 * stream.Uniform());
  }
  return image;
}

double LargestDifference(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_INF);
}

// 1280 × 720 fits 352 × 192 in height: 720 / 192 = 3.75 px to one. The middle of the image's first
// pixel is 0.5 / 3.75 of a pixel from the input's edge.
TEST(DetectorInput, LettersTheWholeImage) {
  const InputWindow window = LetterboxWindow({1280, 720}, {352, 192});
  EXPECT_DOUBLE_EQ(window.scale, 3.75);
  const image_box_t first = window.FromImage(Box(0, 0, 37.5, 75));
  EXPECT_NEAR(first.x_px, 0.5 / 3.75 - 0.5, 1e-12);
  EXPECT_NEAR(first.w_px, 10, 1e-12);
  EXPECT_NEAR(first.h_px, 20, 1e-12);
  const image_box_t corner = window.ToImage(Box(170.5, 95.5, 341.0 + 1.0 / 3, 192));
  EXPECT_NEAR(corner.x_px, 171 * 3.75 - 0.5, 1e-9);
  EXPECT_NEAR(corner.y_px, 359.5, 1e-9);
  EXPECT_NEAR(corner.h_px, 720, 1e-9);
}

TEST(DetectorInput, CropsASquareAroundABox) {
  const InputWindow window = CropWindow(Box(100, 50, 40, 20), 2, {128, 128});
  EXPECT_DOUBLE_EQ(window.scale, 80.0 / 128);
  const image_box_t box = window.FromImage(Box(100, 50, 40, 20));
  EXPECT_NEAR(box.x_px, 63.5, 1e-12) << "the middle of 128 pixels";
  EXPECT_NEAR(box.y_px, 63.5, 1e-12);
  EXPECT_NEAR(box.w_px, 64, 1e-12) << "half of the crop";
  EXPECT_NEAR(box.h_px, 32, 1e-12);
}

// 80 px as 32 are 2.5 px to one: 48 px become 19.2 of them. 30 px have no more than 32.
TEST(DetectorInput, ReducesABoxToItsLongerSide) {
  const InputWindow window = ReducedWindow(Box(100, 50, 80, 48), 32);
  EXPECT_DOUBLE_EQ(window.scale, 2.5);
  EXPECT_EQ(window.size, cv::Size(32, 19));
  EXPECT_DOUBLE_EQ(window.left_px, 60);
  EXPECT_DOUBLE_EQ(window.top_px, 50 - 2.5 * 9.5);
  EXPECT_EQ(window.Pixels(7), 3);
  EXPECT_EQ(window.Pixels(0.1), 1);
  EXPECT_DOUBLE_EQ(ReducedWindow(Box(100, 50, 30, 0), 32).scale, 1);
  EXPECT_EQ(ReducedWindow(Box(100, 50, 30, 0), 32).size, cv::Size(30, 1));
}

TEST(DetectorInput, MapsBoxesThereAndBack) {
  for (const double scale : {0.3, 1.0, 3.75}) {
    const InputWindow window{.left_px = -7.25, .top_px = 31, .scale = scale, .size = {128, 64}};
    const image_box_t box = window.ToImage(window.FromImage(Box(12.5, 99, 31, 17)));
    EXPECT_NEAR(box.x_px, 12.5, 1e-9);
    EXPECT_NEAR(box.y_px, 99, 1e-9);
    EXPECT_NEAR(box.w_px, 31, 1e-9);
    EXPECT_NEAR(box.h_px, 17, 1e-9);
  }
}

// Two by two pixels make one; a window that starts a pixel to the left of the image shows grey.
TEST(DetectorInput, AveragesWhatAPixelCovers) {
  cv::Mat image(2, 4, CV_8UC3, cv::Scalar(0, 0, 0));
  image.at<cv::Vec3b>(0, 0) = {100, 40, 8};
  image.at<cv::Vec3b>(1, 1) = {20, 40, 0};
  const cv::Mat half = SeenThrough({.scale = 2, .size = {2, 1}}, image);
  EXPECT_EQ(half.at<cv::Vec3b>(0, 0), cv::Vec3b(30, 20, 2));
  EXPECT_EQ(half.at<cv::Vec3b>(0, 1), cv::Vec3b(0, 0, 0));
  const cv::Mat aside = SeenThrough({.left_px = -1.5, .scale = 2, .size = {1, 1}}, image);
  EXPECT_EQ(aside.at<cv::Vec3b>(0, 0), cv::Vec3b(82, 67, 59))
      << "grey twice, (100, 40, 8) and black: (114 + 114 + 100 + 0) / 4 in red";
}

TEST(DetectorInput, IsTheImageItselfAtItsOwnScale) {
  const cv::Mat image = RandomImage(37, 21);
  EXPECT_EQ(LargestDifference(SeenThrough({.size = {37, 21}}, image), image), 0);
}

// OpenCV's area interpolation is the same mean in floats. Weights here are rounded to 1/256, each
// of up to five rows by at most that: 255 · 5 / 256 of a grey level at worst, and both round.
TEST(DetectorInput, AgreesWithOpenCvInReductions) {
  const cv::Mat image = RandomImage(320, 180);
  for (const int height : {180, 144, 90, 72, 45}) {
    const cv::Size size(height * 16 / 9, height);
    cv::Mat expected;
    cv::resize(image, expected, size, 0, 0, cv::INTER_AREA);
    const cv::Mat seen = SeenThrough({.scale = 180.0 / height, .size = size}, image);
    EXPECT_LE(LargestDifference(seen, expected), 3) << height;
    EXPECT_LE(cv::norm(seen, expected, cv::NORM_L1) / static_cast<double>(3 * seen.total()), 0.5);
  }
}

// Inside, where no grey is mixed in; OpenCV rounds its weights to 1/2048.
TEST(DetectorInput, AgreesWithOpenCvInEnlargements) {
  const cv::Mat image = RandomImage(40, 30);
  for (const int factor : {2, 3, 5}) {
    cv::Mat expected;
    cv::resize(image, expected, {}, factor, factor, cv::INTER_LINEAR);
    const cv::Mat seen = SeenThrough({.scale = 1.0 / factor, .size = expected.size()}, image);
    const cv::Rect inside(factor, factor, 38 * factor, 28 * factor);
    EXPECT_LE(LargestDifference(seen(inside), expected(inside)), 2) << factor;
  }
}

TEST(DetectorInput, IsGreyBeyondTheImage) {
  const cv::Mat image = RandomImage(16, 16);
  for (const double left : {-1e6, -40.5, 15.5, 1e6}) {
    const cv::Mat seen = SeenThrough({.left_px = left, .scale = 1.5, .size = {16, 16}}, image);
    EXPECT_EQ(LargestDifference(seen, cv::Mat(16, 16, CV_8UC3, cv::Scalar::all(114))), 0) << left;
  }
}

TEST(DetectorInput, LaysColoursOutAsPlanes) {
  cv::Mat image(1, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {255, 0, 51};
  image.at<cv::Vec3b>(0, 1) = {0, 102, 255};
  std::vector<float> planes(6);
  ToPlanes(image, planes);
  EXPECT_THAT(planes, ElementsAre(1.f, 0.f, 0.f, 0.4f, 0.2f, 1.f));
  EXPECT_THROW(ToPlanes(image, std::span(planes).first(5)), std::invalid_argument);
}

TEST(DetectorInput, RefusesOtherImages) {
  EXPECT_THROW(SeenThrough({.size = {8, 8}}, cv::Mat()), std::invalid_argument);
  EXPECT_THROW(SeenThrough({.size = {8, 8}}, cv::Mat(8, 8, CV_8UC1)), std::invalid_argument);
}

}  // namespace
}  // namespace windhover
