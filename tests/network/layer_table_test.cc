#include "network/layer_table.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/dnn.hpp>

#include "common/random/random_stream.h"
#include "network/network_onnx.h"
#include "network/yolox.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// 3 × 8 × 8 -> depthwise 3 × 3 -> 1 × 1 of stride 2 -> twice as large.
LayerTable Small() {
  Layer input{.kind = LayerKind::kInput, .name = "images", .inputs = {}, .channels = 3};
  Layer depthwise{.kind = LayerKind::kConv, .name = "a", .inputs = {0}, .channels = 3};
  depthwise.kernel = 3;
  depthwise.groups = 3;
  depthwise.batch_norm = true;
  Layer conv{.kind = LayerKind::kConv, .name = "b", .inputs = {1}, .channels = 5};
  conv.stride = 2;
  Layer up{.kind = LayerKind::kUpsample, .name = "c", .inputs = {2}, .channels = 5};
  return {.name = "small", .layers = {input, depthwise, conv, up}, .outputs = {3}};
}

std::string Complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

// --- Worked examples. ----------------------------------------------------------------------------

TEST(LayerTable, HasTheShapesCountsAndProductsOfAWorkedExample) {
  const LayerTable table = Small();
  EXPECT_THAT(ShapesOf(table, 8, 6), ElementsAre(LayerShape{3, 8, 6}, LayerShape{3, 8, 6},
                                                 LayerShape{5, 4, 3}, LayerShape{5, 8, 6}));
  EXPECT_EQ(ParameterCount(table), (3 * 9 + 2 * 3) + (5 * 3 + 5));
  EXPECT_EQ(MultiplyCount(table, 8, 6), 3 * 9 * 8 * 6 + 5 * 3 * 4 * 3);
}

TEST(LayerTable, SaysWhichLayerDoesNotFit) {
  LayerTable table = Small();
  table.layers[1].groups = 2;
  EXPECT_THAT(Complaint([&] { ShapesOf(table, 8, 8); }), HasSubstr("layer a: groups"));
  table = Small();
  table.layers[3].channels = 4;
  EXPECT_THAT(Complaint([&] { ShapesOf(table, 8, 8); }), HasSubstr("layer c: gives another"));
  table = Small();
  table.layers[2].inputs = {2};
  EXPECT_THAT(Complaint([&] { ShapesOf(table, 8, 8); }), HasSubstr("layer b: takes what comes"));
  table = Small();
  table.layers[2].name = "a";
  EXPECT_THAT(Complaint([&] { ShapesOf(table, 8, 8); }), HasSubstr("layer a: has the name"));
}

TEST(LayerTable, SaysWhichWeightsAreWrong) {
  const LayerTable table = Small();
  NetworkWeights weights = RandomWeights(table, 1);
  EXPECT_EQ(Complaint([&] { CheckWeights(table, weights); }), "");
  weights.layers[2].bias.pop_back();
  EXPECT_THAT(Complaint([&] { CheckWeights(table, weights); }), HasSubstr("layer b: wrong number"));
  weights = RandomWeights(table, 1);
  weights.layers[1].weight[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(Complaint([&] { NetworkOnnx(table, weights, 8, 8); }),
              HasSubstr("layer a: weights must be finite"));
}

// The paper's table: 0.90 M parameters. YOLOX publishes 0.91 M for 80 classes and 1.08 GFLOP at 416
// × 416, which also counts activations; two FLOP are one multiply-accumulate.
TEST(Yolox, NanoHasThePublishedSize) {
  const YoloxNetwork nano = MakeYolox("yolox_nano");
  EXPECT_EQ(ParameterCount(nano.table), 896754);
  EXPECT_NEAR(2e-9 * static_cast<double>(MultiplyCount(nano.table, 416, 416)), 1.08, 0.08);
}

TEST(Yolox, GivesSixNumbersForEachCellOfEachLevel) {
  for (const std::string& name : kYoloxNetworks) {
    const YoloxNetwork network = MakeYolox(name);
    const auto shapes = ShapesOf(network.table, network.height, network.width);
    ASSERT_EQ(network.table.outputs.size(), network.strides.size());
    for (std::size_t i = 0; i < network.strides.size(); ++i) {
      const int stride = network.strides[i];
      EXPECT_EQ(shapes[static_cast<std::size_t>(network.table.outputs[i])],
                (LayerShape{6, network.height / stride, network.width / stride}));
    }
  }
}

// --- The written file against a program of others. -----------------------------------------------

using Maps = std::vector<float>;

float Activated(float x, Activation activation) {
  if (activation == Activation::kRelu) return std::max(x, 0.0f);
  return activation == Activation::kSilu ? x / (1 + std::exp(-x)) : x;
}

/// One pixel of a convolution or of a maximum, by the definition.
float WindowValue(const LayerTable& table, const Layer& layer, const ConvWeights& weights,
                  const LayerShape& in, const Maps& x, const std::array<int, 3>& cyx) {
  const bool conv = layer.kind == LayerKind::kConv;
  const int k = layer.kernel, pad = (k - 1) / 2;
  const int n = conv ? InputChannels(table, layer) / layer.groups : 1;
  const int first = conv ? cyx[0] / (layer.channels / layer.groups) * n : cyx[0];
  double sum = 0, greatest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < n * k * k; ++i) {
    const int row = cyx[1] * layer.stride - pad + i / k % k;
    const int column = cyx[2] * layer.stride - pad + i % k;
    if (row < 0 || column < 0 || row >= in.height || column >= in.width) continue;
    const int at = ((first + i / (k * k)) * in.height + row) * in.width + column;
    const double value = x[static_cast<std::size_t>(at)];
    greatest = std::max(greatest, value);
    if (conv) sum += value * weights.weight[static_cast<std::size_t>(cyx[0] * n * k * k + i)];
  }
  if (!conv) return static_cast<float>(greatest);
  sum += weights.bias[static_cast<std::size_t>(cyx[0])];
  return Activated(static_cast<float>(sum), layer.activation);
}

/// The table's meaning, without any haste.
std::vector<Maps> MapsOf(const LayerTable& table, const NetworkWeights& weights, int height,
                         int width, const Maps& image) {
  const std::vector<LayerShape> shapes = ShapesOf(table, height, width);
  std::vector<Maps> maps = {image};
  for (std::size_t l = 1; l < shapes.size(); ++l) {
    const Layer& layer = table.layers[l];
    const auto first = static_cast<std::size_t>(layer.inputs[0]);
    Maps out;
    for (int c = 0; c < shapes[l].channels && layer.kind != LayerKind::kConcat; ++c) {
      for (int y = 0; y < shapes[l].height; ++y) {
        for (int x = 0; x < shapes[l].width; ++x) {
          const int at = (c * shapes[first].height + y / 2) * shapes[first].width + x / 2;
          out.push_back(layer.kind == LayerKind::kUpsample
                            ? maps[first][static_cast<std::size_t>(at)]
                        : layer.kind == LayerKind::kAdd
                            ? maps[first][out.size()] +
                                  maps[static_cast<std::size_t>(layer.inputs[1])][out.size()]
                            : WindowValue(table, layer, weights.layers[l], shapes[first],
                                          maps[first], {c, y, x}));
        }
      }
    }
    if (layer.kind == LayerKind::kConcat) {
      for (const int i : layer.inputs) {
        const Maps& part = maps[static_cast<std::size_t>(i)];
        out.insert(out.end(), part.begin(), part.end());
      }
    }
    maps.push_back(std::move(out));
  }
  return maps;
}

class YoloxOnnx : public ::testing::TestWithParam<std::string> {};

TEST_P(YoloxOnnx, GivesInOpenCvWhatTheTableMeans) {
  const YoloxNetwork network = MakeYolox(GetParam());
  const NetworkWeights weights = RandomWeights(network.table, 3);
  const int height = 32, width = 64;
  const std::string model = NetworkOnnx(network.table, weights, height, width);
  cv::dnn::Net net = cv::dnn::readNetFromONNX(model.data(), model.size());
  cv::Mat image(std::vector<int>{1, 3, height, width}, CV_32F);
  RandomStream random(3, "test/image");
  Maps pixels;
  for (auto it = image.begin<float>(); it != image.end<float>(); ++it) {
    pixels.push_back(*it = static_cast<float>(random.Uniform()));
  }
  const std::vector<Maps> expected = MapsOf(network.table, weights, height, width, pixels);
  net.setInput(image, "images");
  for (const int output : network.table.outputs) {
    const auto o = static_cast<std::size_t>(output);
    const cv::Mat result = net.forward(network.table.layers[o].name);
    ASSERT_EQ(result.total(), expected[o].size());
    float scale = 1;
    for (const float value : expected[o]) scale = std::max(scale, std::abs(value));
    for (std::size_t i = 0; i < expected[o].size(); ++i) {
      // float's 6e-8 of each of some hundred sums on the way.
      ASSERT_NEAR(result.ptr<float>()[i], expected[o][i], 1e-5 * scale);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, YoloxOnnx, ::testing::ValuesIn(kYoloxNetworks));

}  // namespace
}  // namespace windhover
