#include "estimator/classical_detector.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "common/random/random_stream.h"

namespace windhover {
namespace {

using ::testing::HasSubstr;

constexpr int kWidth = 1280, kHeight = 720;
constexpr int kFine = 4;  // Targets are drawn on a finer grid: positions to a quarter of a pixel.

struct Target {
  double left_x_px, y_px;
  double disparity_px;
  double width_px;
  cv::Scalar colour{220, 110, 20};
};

/// Soft blotches, different in every place, as far away as the stars.
cv::Mat Texture(std::uint64_t seed) {
  RandomStream random(seed, "texture");
  cv::Mat coarse(kHeight / 12, (kWidth + 400) / 12, CV_8UC3), fine;
  for (auto& pixel : cv::Mat_<cv::Vec3b>(coarse)) {
    const double grey = random.Uniform(70, 150);
    pixel = cv::Vec3b(cv::saturate_cast<uchar>(grey * 0.8), cv::saturate_cast<uchar>(grey),
                      cv::saturate_cast<uchar>(grey * 0.6));
  }
  cv::resize(coarse, fine, {kWidth + 400, kHeight}, 0, 0, cv::INTER_CUBIC);
  return fine;
}

cv::Mat Sky() {
  cv::Mat sky(kHeight, kWidth + 400, CV_8UC3);
  for (int y = 0; y < kHeight; ++y) sky.row(y) = cv::Scalar(150 - y / 12, 180 - y / 16, 220);
  return sky;
}

/// A body with two rising arms, a motor at the end of each, and two legs; its box is `width_px`
/// wide and half as high.
void Draw(const Target& target, double x_px, cv::Mat* image) {
  const double size_px = target.width_px;
  const cv::Rect around(static_cast<int>(x_px - size_px), static_cast<int>(target.y_px - size_px),
                        static_cast<int>(2 * size_px), static_cast<int>(2 * size_px));
  const cv::Rect crop = around & cv::Rect({0, 0}, image->size());
  cv::Mat fine;
  cv::resize((*image)(crop), fine, {}, kFine, kFine, cv::INTER_NEAREST);
  const auto at = [&](double x, double y) {
    return cv::Point(
        static_cast<int>(std::lround((x_px + x * size_px - crop.x + 0.5) * kFine)),
        static_cast<int>(std::lround((target.y_px + y * size_px - crop.y + 0.5) * kFine)));
  };
  const cv::Scalar dark(25, 25, 30);
  for (const double side : {-1, 1}) {
    cv::rectangle(fine, at(side * 0.5, -0.25), at(side * 0.38, -0.13), dark, cv::FILLED);
    const std::vector<cv::Point> arm{at(side * 0.44, -0.2), at(side * 0.44, -0.14), at(0, 0.05),
                                     at(0, -0.03)};
    cv::fillConvexPoly(fine, arm, dark);
    const std::vector<cv::Point> leg{at(side * 0.08, 0), at(side * 0.13, 0), at(side * 0.25, 0.25),
                                     at(side * 0.19, 0.25)};
    cv::fillConvexPoly(fine, leg, dark);
  }
  cv::rectangle(fine, at(-0.14, -0.1), at(0.14, 0.1), target.colour, cv::FILLED);
  cv::resize(fine, fine, crop.size(), 0, 0, cv::INTER_AREA);
  fine.copyTo((*image)(crop));
}

struct Pair {
  cv::Mat left, right;
};

/// What a rig sees whose right image has the background `shift` px further left, with noise.
Pair Render(const cv::Mat& far, cv::Point shift, const std::vector<Target>& targets) {
  Pair pair{far({200, 0, kWidth, kHeight}).clone(), {}};
  pair.right = cv::Mat(kHeight, kWidth, CV_8UC3);
  const cv::Matx23d moving(1, 0, -200.0 - shift.x, 0, 1, -shift.y);
  cv::warpAffine(far, pair.right, moving, pair.right.size(), cv::INTER_NEAREST,
                 cv::BORDER_REPLICATE);
  for (const Target& target : targets) {
    Draw(target, target.left_x_px, &pair.left);
    Target in_right = target;
    in_right.y_px -= shift.y;
    Draw(in_right, target.left_x_px - shift.x - target.disparity_px, &pair.right);
  }
  RandomStream random(1, "noise");
  for (cv::Mat* image : {&pair.left, &pair.right}) {
    for (auto& pixel : cv::Mat_<cv::Vec3b>(*image)) {
      for (int c = 0; c < 3; ++c) {
        pixel[c] = cv::saturate_cast<uchar>(pixel[c] + 2 * random.Normal());
      }
    }
  }
  return pair;
}

std::vector<stereo_box_t> Detect(const Pair& pair) {
  return ClassicalDetector().Detect(pair.left, pair.right);
}

struct Place {
  Target target;
  cv::Point shift;
  bool plain;

  friend std::ostream& operator<<(std::ostream& out, const Place& place) {
    return out << place.target.width_px << " px wide, background "
               << (place.plain ? "plain" : "textured") << ", shifted by " << place.shift;
  }
};

class FindsTarget : public ::testing::TestWithParam<Place> {};

// Edges are seen to a pixel of the resolution that a target's size is refined at: 1 px up to
// 200 px of width, 2 px up to 400, then 4. The disparity is a match of many pixels; least squares
// with a parabola are within 0.1 px of the finer grid's quarters, times that resolution.
TEST_P(FindsTarget, WhereItWasDrawn) {
  const auto& [target, shift, plain] = GetParam();
  const auto boxes = Detect(Render(plain ? Sky() : Texture(1), shift, {target}));
  ASSERT_EQ(boxes.size(), 1u);
  const double resolution_px = target.width_px <= 200 ? 1 : target.width_px <= 400 ? 2 : 4;
  EXPECT_NEAR(boxes[0].left.x_px, target.left_x_px, 1.5 * resolution_px);
  EXPECT_NEAR(boxes[0].left.y_px, target.y_px, 1.5 * resolution_px);
  EXPECT_NEAR(boxes[0].left.w_px, target.width_px, 3 * resolution_px);
  EXPECT_NEAR(boxes[0].left.h_px, target.width_px / 2, 3 * resolution_px);
  EXPECT_NEAR(boxes[0].left.x_px - boxes[0].right.x_px, target.disparity_px + shift.x,
              0.25 * resolution_px);
  EXPECT_NEAR(boxes[0].left.y_px - boxes[0].right.y_px, shift.y, 0.5 * resolution_px);
  EXPECT_GT(boxes[0].score, 0);
  EXPECT_LE(boxes[0].score, 1);
}

INSTANTIATE_TEST_SUITE_P(Places, FindsTarget,
                         ::testing::Values(Place{{600, 300, 33.25, 48}, {0, 0}, false},
                                           Place{{700.5, 200.25, 33.25, 60}, {73, 6}, false},
                                           Place{{900, 500, 65.5, 120}, {-40, -9}, false},
                                           Place{{640.25, 360, 130, 230}, {73, 3}, false},
                                           Place{{800, 380, 260, 560}, {73, -3}, false},
                                           Place{
                                               {700, 300, 40.5, 70, {30, 30, 35}}, {10, 2}, false},
                                           Place{{700, 300, 65.5, 120}, {0, 0}, true},
                                           Place{{700.5, 300, 100, 60}, {0, 0}, true}));

TEST(ClassicalDetector, FindsNothingWhereNothingIs) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    EXPECT_TRUE(Detect(Render(Texture(seed), {73, 5}, {})).empty()) << seed;
  }
  EXPECT_TRUE(Detect(Render(Sky(), {0, 0}, {})).empty());
}

TEST(ClassicalDetector, FindsTwoTargets) {
  const std::vector<Target> targets{{400, 250, 45, 80}, {900, 480, 90, 160, {40, 40, 45}}};
  auto boxes = Detect(Render(Texture(5), {20, 1}, targets));
  ASSERT_EQ(boxes.size(), 2u);
  std::sort(boxes.begin(), boxes.end(), [](auto& a, auto& b) { return a.left.x_px < b.left.x_px; });
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(boxes[i].left.x_px, targets[i].left_x_px, 2);
    EXPECT_NEAR(boxes[i].left.x_px - boxes[i].right.x_px, targets[i].disparity_px + 20, 0.5);
  }
}

TEST(ClassicalDetector, RemembersNothing) {
  const Pair pair = Render(Texture(1), {73, 6}, {{700, 200, 33, 60}});
  const Pair other = Render(Texture(2), {0, 0}, {{300, 500, 90, 150}});
  ClassicalDetector detector;
  const auto before = detector.Detect(pair.left, pair.right);
  detector.Detect(other.left, other.right);
  const auto after = detector.Detect(pair.left, pair.right);
  ASSERT_EQ(before.size(), after.size());
  EXPECT_EQ(before.at(0).right.x_px, after.at(0).right.x_px);
}

TEST(ClassicalDetector, RefusesImagesThatAreNoPair) {
  ClassicalDetector detector;
  const cv::Mat good(100, 100, CV_8UC3, cv::Scalar(0, 0, 0));
  EXPECT_TRUE(detector.Detect(good, good).empty());
  for (const cv::Mat& bad : {cv::Mat(), cv::Mat(100, 99, CV_8UC3), cv::Mat(100, 100, CV_8UC1)}) {
    EXPECT_THROW(detector.Detect(good, bad), std::invalid_argument);
    EXPECT_THROW(detector.Detect(bad, good), std::invalid_argument);
  }
  const cv::Mat tiny(63, 100, CV_8UC3, cv::Scalar(0, 0, 0));
  try {
    detector.Detect(tiny, tiny);
    FAIL() << "no exception";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("at least 64 x 64 px (found 100 x 63"));
  }
}

}  // namespace
}  // namespace windhover
