#include "network/inference.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "network/box_decoding.h"
#include "network/network_file.h"
#include "network/network_onnx.h"
#include "network/yolox.h"
#include "tests/support/image_box.h"

namespace windhover {
namespace {

std::vector<float> RandomImages(std::size_t n) {
  RandomStream stream(3, "images");
  std::vector<float> images(n);
  for (float& value : images) value = static_cast<float>(stream.Uniform());
  return images;
}

/// A YOLOX with random weights, as it comes out of a file.
NetworkModel RandomModel(const YoloxNetwork& network, int height, int width) {
  const NetworkWeights weights = RandomWeights(network.table, 5);
  return ParseNetwork(NetworkOnnx(network.table, weights, height, width), "random.onnx");
}

// The two engines share nothing but the file: windhover's reading, oneDNN's convolutions and
// OpenCV's own reading and convolutions. Sums of some hundred products in float32, in different
// orders, through 80 layers: 1e-4 of the largest output is what the requirement asks for.
TEST(Inference, OneDnnAgreesWithOpenCv) {
  for (const std::string& name : kYoloxNetworks) {
    const YoloxNetwork network = MakeYolox(name);
    const NetworkModel model = RandomModel(network, 96, 160);
    const InferenceTask task{model.table, model.weights, ShapesOf(model.table, 96, 160), 2};
    const auto fast = Inference().make_onednn(task);
    const auto reference = Inference().make_opencv(task, model.onnx_file);
    const std::vector<float> images = RandomImages(2 * 3 * 96 * 160);
    fast->Run(images);
    reference->Run(images);
    for (std::size_t i = 0; i < model.table.outputs.size(); ++i) {
      const auto a = fast->Output(i), b = reference->Output(i);
      ASSERT_EQ(a.size(), b.size());
      float largest = 0, difference = 0;
      for (std::size_t k = 0; k < a.size(); ++k) {
        largest = std::max(largest, std::abs(b[k]));
        difference = std::max(difference, std::abs(a[k] - b[k]));
      }
      EXPECT_GT(largest, 1e-3) << name << ": all but silent, nothing would be compared";
      EXPECT_LT(difference, 1e-4 * std::max(1.f, largest)) << name << " output " << i;
    }
  }
}

/// One level of 2 x 3 cells, whose cell in row 1, column 2 sees a box of 3 x 2 cells.
std::vector<float> OneBox() {
  std::vector<float> values(6 * 6, -20.f);
  const float cell[] = {0.5f, 0.25f, std::log(3.f), std::log(2.f), 2.f, 1.f};
  for (std::size_t k = 0; k < 6; ++k) values[6 * k + 5] = cell[k];
  return values;
}

// Centre ((2 + 0.5) 8 - 0.5, (1 + 0.25) 8 - 0.5), size 3 · 8 × 2 · 8, score 0.8808 · 0.7311.
TEST(BoxDecoding, WorkedExample) {
  const std::vector<float> values = OneBox();
  const YoloxLevel level{.values = values, .height = 2, .width = 3, .stride = 8};
  const auto boxes = DecodeBoxes({&level, 1}, 0.3);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].box.x_px, 19.5, 1e-6);
  EXPECT_NEAR(boxes[0].box.y_px, 9.5, 1e-6);
  EXPECT_NEAR(boxes[0].box.w_px, 24, 1e-5);
  EXPECT_NEAR(boxes[0].box.h_px, 16, 1e-5);
  EXPECT_NEAR(boxes[0].score, 0.8808 * 0.7311, 1e-4);
  EXPECT_TRUE(DecodeBoxes({&level, 1}, 0.65).empty());
}

TEST(BoxDecoding, RefusesNumbersThatAreNotFinite) {
  std::vector<float> values = OneBox();
  values[3] = std::numeric_limits<float>::infinity();
  const YoloxLevel level{.values = values, .height = 2, .width = 3, .stride = 8};
  EXPECT_THROW(DecodeBoxes({&level, 1}, 0.3), std::runtime_error);
}

TEST(BoxDecoding, LeavesOutBoxesBeyondReason) {
  for (const auto& [channel, value] : {std::pair{0, 1e30f}, {1, -9.f}, {2, 80.f}, {3, 10.f}}) {
    std::vector<float> values = OneBox();
    values[static_cast<std::size_t>(6 * channel + 5)] = value;
    const YoloxLevel level{.values = values, .height = 2, .width = 3, .stride = 8};
    EXPECT_TRUE(DecodeBoxes({&level, 1}, 0.3).empty()) << channel;
  }
}

// Two squares of 2, one to the right of the other by 1: 2 of 6 are shared.
TEST(BoxDecoding, OverlapIsOfTheUnion) {
  EXPECT_NEAR(OverlapOf(Box(0, 0, 2, 2), Box(1, 0, 2, 2)), 2.0 / 6, 1e-12);
  EXPECT_EQ(OverlapOf(Box(0, 0, 2, 2), Box(2, 0, 2, 2)), 0);
  EXPECT_NEAR(OverlapOf(Box(3, 4, 2, 5), Box(3, 4, 2, 5)), 1, 1e-12);
}

TEST(BoxDecoding, KeepsTheBestOfDoubles) {
  const std::vector<ScoredBox> boxes = {{Box(0, 0, 10, 10), 0.5},
                                        {Box(1, 0, 10, 10), 0.9},
                                        {Box(30, 0, 10, 10), 0.7},
                                        {Box(60, 0, 10, 10), 0.6}};
  const auto kept = WithoutDoubles(boxes, 0.5, 2);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].score, 0.9);
  EXPECT_EQ(kept[1].score, 0.7);
}

}  // namespace
}  // namespace windhover
