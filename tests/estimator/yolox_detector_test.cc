#include "estimator/yolox_detector.h"

#include <cmath>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/file/sha256.h"
#include "estimator/stereo_pairing.h"
#include "network/network_onnx.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

ScoredBox Scored(double x, double y, double w, double h) {
  ScoredBox scored{.score = 0.9};
  scored.box.x_px = x;
  scored.box.y_px = y;
  scored.box.w_px = w;
  scored.box.h_px = h;
  return scored;
}

/// A network that can be followed by hand: where the red of a cell of 8 px is 1, it sees a box of
/// `cells` cells around its middle; where it is below 0.5, none (40 · red + bias as a logit).
NetworkWeights RedFinder(const LayerTable& table, double cells, float bias = -30) {
  NetworkWeights weights;
  weights.layers.resize(table.layers.size());
  ConvWeights& conv = weights.layers[1];
  conv.weight.assign(6 * 3 * 8 * 8, 0.f);
  for (std::size_t i = 0; i < 64; ++i) conv.weight[4 * 3 * 64 + i] = 40.f / 64;
  const float size = static_cast<float>(std::log(cells));
  // The convolution's window begins 3 px before its cell.
  conv.bias = {0.125f, 0.125f, size, size, bias, 20.f};
  return weights;
}

LayerTable RedFinderTable() {
  LayerTable table{.name = "red", .layers = {}, .outputs = {1}};
  table.layers.push_back(
      {.kind = LayerKind::kInput, .name = "images", .inputs = {}, .channels = 3});
  table.layers.push_back({.kind = LayerKind::kConv,
                          .name = "conv",
                          .inputs = {0},
                          .channels = 6,
                          .kernel = 8,
                          .stride = 8});
  return table;
}

/// A detector of red squares: boxes of 8 cells, 240 px of an image of 1280 x 720, and again as
/// large as the square that it sees.
class YoloxDetectorTest : public ::testing::Test {
 protected:
  /// `bias_again`: of the second network.
  DetectorCard Card(bool refines, float bias_again = -30) const {
    const auto weights = [&](const std::string& name, int height, int width, const auto& finder) {
      const auto file = folder_.Write(name, NetworkOnnx(RedFinderTable(), finder, height, width));
      return DetectorCard::Weights{name, Sha256OfFile(file)};
    };
    const LayerTable table = RedFinderTable();
    DetectorCard card;
    card.network = "yolox_nano";
    card.detector = weights("whole.onnx", 192, 352, RedFinder(table, 8));
    if (refines) card.refiner = weights("again.onnx", 128, 128, RedFinder(table, 16, bias_again));
    card.refiner_margin = 1;
    return card;
  }

  std::vector<stereo_box_t> Detect(const cv::Mat& left, const cv::Mat& right,
                                   bool refines = true) const {
    return YoloxDetector(Card(refines), folder_.path()).Detect(left, right);
  }

  /// A red square of `side` px with its middle at (x, y).
  static cv::Mat Image(double x, double y, int side) {
    cv::Mat image(720, 1280, CV_8UC3, cv::Scalar(0, 0, 0));
    const cv::Rect square(static_cast<int>(x) - side / 2, static_cast<int>(y) - side / 2, side,
                          side);
    image(square & cv::Rect(0, 0, 1280, 720)).setTo(cv::Scalar(255, 255, 255));
    return image;
  }

  const TemporaryFolder folder_;
};

// Squares around cells of the first look, 30 px wide, which see them in their middles, 0.25 px off.
// Each time they are looked at again the middle lies 1 px of the input off a cell's, 1.9 px of the
// image, and that twice.
TEST_F(YoloxDetectorTest, FindsWhatBothImagesShow) {
  for (const bool refines : {false, true}) {
    const auto boxes = Detect(Image(603, 363, 34), Image(513, 363, 34), refines);
    ASSERT_EQ(boxes.size(), 1u);
    const double tolerance_px = refines ? 4.1 : 1;
    EXPECT_NEAR(boxes[0].left.x_px, 603, tolerance_px);
    EXPECT_NEAR(boxes[0].right.x_px, 513, tolerance_px);
    EXPECT_NEAR(boxes[0].left.y_px, 363, tolerance_px);
    EXPECT_NEAR(boxes[0].left.w_px, 240, 1e-3);
    EXPECT_GT(boxes[0].score, 0.3);
  }
}

// Of white the first says 1; the second σ(40 + bias) = 0.5, σ(-0.5) = 0.378, then σ(-2) = 0.119,
// less than the card's 0.3.
TEST_F(YoloxDetectorTest, SecondLookDecides) {
  const cv::Mat left = Image(603, 363, 34), right = Image(513, 363, 34);
  const auto score = [&](float bias) {
    const auto boxes = YoloxDetector(Card(true, bias), folder_.path()).Detect(left, right);
    return boxes.empty() ? 0 : boxes[0].score;
  };
  EXPECT_NEAR(score(-40), 0.5, 1e-4);
  EXPECT_NEAR(score(-40.5), 1 / (1 + std::exp(0.5)), 1e-4);
  EXPECT_EQ(score(-42), 0);
}

TEST_F(YoloxDetectorTest, OneImageAloneIsNoDetection) {
  const cv::Mat empty(720, 1280, CV_8UC3, cv::Scalar(0, 0, 0));
  EXPECT_TRUE(Detect(Image(603, 363, 34), empty).empty());
  EXPECT_TRUE(Detect(empty, empty).empty());
}

// At 528 px the square lies across two cells of the first look, which sees it in the left image
// alone; the second has cells of 15 px, of which it covers two.
TEST_F(YoloxDetectorTest, SearchesWhatOneImageShows) {
  for (const bool is_left : {true, false}) {
    const double left = is_left ? 603 : 618, right = is_left ? 528 : 513;
    const cv::Mat left_rgb = Image(left, 363, 34), right_rgb = Image(right, 363, 34);
    EXPECT_TRUE(Detect(left_rgb, right_rgb, /*refines=*/false).empty());
    const auto boxes = Detect(left_rgb, right_rgb);
    ASSERT_EQ(boxes.size(), 1u) << is_left;
    EXPECT_NEAR(boxes[0].left.x_px - boxes[0].right.x_px, left - right, 1) << is_left;
  }
}

TEST_F(YoloxDetectorTest, OtherRowsAreAnotherTarget) {
  EXPECT_TRUE(Detect(Image(603, 363, 34), Image(513, 543, 34)).empty());
}

TEST_F(YoloxDetectorTest, LooksAtEachImageForItself) {
  YoloxDetector detector(Card(true), folder_.path());
  const auto found = detector.DetectEach(Image(603, 363, 34), Image(213, 543, 34), 0.3);
  ASSERT_EQ(found.size(), 2u);
  ASSERT_EQ(found[0].size(), 1u);
  ASSERT_EQ(found[1].size(), 1u);
  EXPECT_NEAR(found[1][0].box.x_px, 213, 4.1);
}

TEST_F(YoloxDetectorTest, BothEnginesAgree) {
  const cv::Mat left = Image(603, 363, 34), right = Image(513, 363, 34);
  const auto a = Detect(left, right);
  const auto b = YoloxDetector(Card(true), folder_.path(), EngineKind::kOpenCv).Detect(left, right);
  ASSERT_EQ(a.size(), 1u);
  ASSERT_EQ(b.size(), 1u);
  EXPECT_NEAR(a[0].left.x_px, b[0].left.x_px, 1e-4 * 603);
  EXPECT_NEAR(a[0].score, b[0].score, 1e-4);
}

TEST_F(YoloxDetectorTest, RefusesOtherImages) {
  const cv::Mat image = Image(603, 363, 34);
  EXPECT_THROW(Detect(image, cv::Mat(720, 1280, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(Detect(image, image(cv::Rect(0, 0, 640, 720))), std::invalid_argument);
  EXPECT_THROW(Detect(cv::Mat(), cv::Mat()), std::invalid_argument);
}

TEST_F(YoloxDetectorTest, IsMadeFromACard) {
  EstimatorConfig config;
  config.detector = "yolox_nano";
  config.detector_model.as_given = "card.json";
  config.detector_model.absolute = folder_.Write("card.json", DetectorCardText(Card(true)));
  config.detector_model.where = "s.yaml:3:5";
  EXPECT_EQ(MakeDetector(config)->Detect(Image(603, 363, 34), Image(513, 363, 34)).size(), 1u);
  config.detector = "yolox_small";
  try {
    MakeDetector(config);
    FAIL() << "a card of another network";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("s.yaml:3:5: "));
    EXPECT_THAT(error.what(), HasSubstr("network: must be yolox_small, as estimator.detector "
                                        "(found yolox_nano)"));
  }
}

// 720 rows: centres may differ by 14.4 px and half of the boxes' height.
TEST(StereoPairing, KeepsToTheRows) {
  const cv::Size image(1280, 720);
  const std::vector<ScoredBox> left = {Scored(600, 300, 40, 20)};
  EXPECT_THAT(PairBoxes(left, {Scored(500, 324, 40, 20)}, image), ElementsAre(Pair(0u, 0u)));
  EXPECT_TRUE(PairBoxes(left, {Scored(500, 325, 40, 20)}, image).empty());
  EXPECT_TRUE(PairBoxes(left, {Scored(500, 300, 66, 20)}, image).empty()) << "1.65 times as wide";
  EXPECT_TRUE(PairBoxes(left, {Scored(640, 300, 40, 20)}, image).empty()) << "behind the rig";
}

TEST(StereoPairing, TakesWhatDiffersLeast) {
  const std::vector<ScoredBox> left = {Scored(600, 300, 40, 20), Scored(650, 308, 44, 22)};
  const std::vector<ScoredBox> right = {Scored(560, 308, 44, 22), Scored(520, 301, 41, 20),
                                        Scored(90, 700, 40, 20)};
  EXPECT_THAT(PairBoxes(left, right, {1280, 720}), ElementsAre(Pair(0u, 1u), Pair(1u, 0u)));
}

}  // namespace
}  // namespace windhover
