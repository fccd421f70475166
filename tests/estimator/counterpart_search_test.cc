#include "estimator/counterpart_search.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/blotches.h"
#include "tests/support/image_box.h"

namespace windhover {
namespace {

// A target 80 px wide is compared at a scale of 80 / 32 = 2.5: half of that is what it errs by.
TEST(FindCounterpart, WorkedExample) {
  const cv::Mat left = Image(300, 180, 70, Sky()), right = Image(210, 182, 70, Sky());
  const image_box_t in_right = FindCounterpart(left, 0, Box(300, 180, 80, 48), right);
  EXPECT_NEAR(in_right.x_px, 210, 1.25);
  EXPECT_NEAR(in_right.y_px, 182, 1.25);
  EXPECT_EQ(in_right.w_px, 80);
  EXPECT_EQ(in_right.h_px, 48);
  EXPECT_NEAR(FindCounterpart(right, 1, Box(210, 182, 80, 48), left).x_px, 300, 1.25);
}

// Half a pixel of the scale, and a quarter for what leaves add.
TEST(FindCounterpart, FindsAnySizeAndParallax) {
  std::uint64_t number = 0;
  for (const double size_px : {12., 24., 60., 150.}) {
    for (const double parallax_px : {-8., 3.3, 40.7, 260.2}) {
      const std::uint64_t seed = 2 * ++number;
      const cv::Mat left = Image(480, 175, size_px, Leaves(30, seed));
      const cv::Mat right = Image(480 - parallax_px, 175, size_px, Leaves(30, seed + 1));
      const image_box_t found = FindCounterpart(left, 0, Box(480, 175, size_px, size_px), right);
      EXPECT_NEAR(480 - found.x_px, parallax_px, 0.75 * std::max(1.0, size_px / 32))
          << size_px << " " << parallax_px;
    }
  }
}

// 360 rows: 2 % of them are 7.2. 640 columns: 2 % of them are 12.8 against the parallax.
TEST(FindCounterpart, KeepsToTheRowsAndBeforeTheRig) {
  const cv::Mat left = Image(300, 180, 30, Sky());
  const image_box_t box = Box(300, 180, 30, 18);
  EXPECT_NEAR(FindCounterpart(left, 0, box, Image(260, 187, 30, Sky())).y_px, 187, 0.5);
  EXPECT_LE(FindCounterpart(left, 0, box, Image(260, 199, 30, Sky())).y_px, 187.5);
  EXPECT_NEAR(FindCounterpart(left, 0, box, Image(312, 180, 30, Sky())).x_px, 312, 0.5);
  EXPECT_LE(FindCounterpart(left, 0, box, Image(330, 180, 30, Sky())).x_px, 313.5);
}

TEST(FindCounterpart, TakesAnyBox) {
  const cv::Mat left = Image(300, 180, 70, Sky());
  for (const image_box_t& odd : {Box(0, 181, 0.1, 3000), Box(-900, 5000, 40, 30),
                                 Box(700, 180, 2600, 1500), Box(0, 0, 0, 0)}) {
    for (const int eye : {0, 1}) {
      const image_box_t found = FindCounterpart(left, eye, odd, Sky());
      EXPECT_TRUE(std::isfinite(found.x_px) && std::isfinite(found.y_px));
    }
  }
}

// 80 px wide: a sixteenth is 5 px.
TEST(ParallaxAgrees, ToASixteenthOfTheWidth) {
  stereo_box_t boxes{};
  boxes.left = Box(300, 180, 100, 48);
  boxes.right = Box(260, 180, 64, 48);
  EXPECT_TRUE(ParallaxAgrees(boxes, 35.01));
  EXPECT_FALSE(ParallaxAgrees(boxes, 34.99));
  EXPECT_TRUE(ParallaxAgrees(boxes, 44.99));
  EXPECT_FALSE(ParallaxAgrees(boxes, 45.01));
}

}  // namespace
}  // namespace windhover
