#include "estimator/box_alignment.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/blotches.h"
#include "tests/support/image_box.h"

namespace windhover {
namespace {

// The target is at 300.0 and 260.3 px. The boxes say 303 and 258, a disparity of 45 px instead of
// 39.7: 5.3 px too much, of which each gets half. A twentieth of a pixel is what the parabola
// leaves.
TEST(AlignBoxes, WorkedExample) {
  stereo_box_t boxes{};
  boxes.left = Box(303, 180, 80, 48);
  boxes.right = Box(258, 181, 84, 50);
  AlignBoxes(Image(300, 180, 70, Sky()), Image(260.3, 180, 70, Sky()), &boxes);
  EXPECT_NEAR(boxes.left.x_px, 303 - 2.65, 0.05);
  EXPECT_NEAR(boxes.right.x_px, 258 + 2.65, 0.05);
  EXPECT_NEAR(boxes.left.y_px, 180.5, 0.05);
  EXPECT_NEAR(boxes.right.y_px, 180.5, 0.05);
  EXPECT_EQ(boxes.left.w_px, 80);
  EXPECT_EQ(boxes.right.h_px, 50);
}

// Whatever the size, the place between pixels and the error, as long as that is less than 8 of the
// pixels that are compared: a tenth of one of those, before leaves a fifth.
TEST(AlignBoxes, FindsTheDisparityOfAnySize) {
  int number = 0;
  for (const double size_px : {24., 60., 150., 260.}) {
    for (const bool has_leaves : {false, true}) {
      for (const double error : {-0.06, -0.01, 0.025, 0.06}) {
        const double fraction = 0.13 * ++number, disparity_px = 40 + 3 * fraction;
        const double x = 330 + fraction, y = 170 + fraction / 2;
        stereo_box_t boxes{};
        boxes.left = Box(x + error * size_px, y, size_px, 0.6 * size_px);
        boxes.right = Box(x - disparity_px, y - 0.02 * size_px, size_px, 0.6 * size_px);
        const auto seed = static_cast<std::uint64_t>(2 * number);
        AlignBoxes(Image(x, y, size_px, has_leaves ? Leaves(30, seed) : Sky()),
                   Image(x - disparity_px, y, size_px, has_leaves ? Leaves(30, seed + 1) : Sky()),
                   &boxes);
        const double compared_px = std::max(1.0, size_px / 96);
        EXPECT_NEAR(boxes.left.x_px - boxes.right.x_px, disparity_px,
                    (has_leaves ? 0.2 : 0.1) * compared_px)
            << size_px << " " << has_leaves << " " << error;
      }
    }
  }
}

TEST(AlignBoxes, LeavesBoxesOfWhatShowsNothing) {
  stereo_box_t boxes{};
  boxes.left = Box(303, 180, 80, 48);
  boxes.right = Box(258, 181, 84, 50);
  AlignBoxes(Sky(), Sky(), &boxes);
  EXPECT_EQ(boxes.left.x_px, 303);
  EXPECT_EQ(boxes.right.x_px, 258);
}

TEST(AlignBoxes, TakesAnyBox) {
  for (const image_box_t& odd : {Box(0, 181, 0.1, 3000), Box(-900, 5000, 40, 30)}) {
    stereo_box_t boxes{};
    boxes.left = Box(303, 180, 80, 48);
    boxes.right = odd;
    AlignBoxes(Image(300, 180, 70, Sky()), Sky(), &boxes);
    EXPECT_TRUE(std::isfinite(boxes.left.x_px) && std::isfinite(boxes.right.y_px));
  }
}

// 12 px are more than it looks for: there the target's other half looks alike by chance at most.
TEST(AlignBoxes, GoesNoFurtherThanAFewPixels) {
  stereo_box_t boxes{};
  boxes.left = Box(312, 180, 80, 48);
  boxes.right = Box(260, 180, 80, 48);
  AlignBoxes(Image(300, 180, 70, Sky()), Image(260, 180, 70, Sky()), &boxes);
  EXPECT_LE(std::abs(boxes.left.x_px - 312), 4);
  EXPECT_EQ(boxes.left.x_px + boxes.right.x_px, 572);
}

}  // namespace
}  // namespace windhover
