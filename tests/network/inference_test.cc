#include "network/inference.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "network/network_file.h"
#include "network/network_onnx.h"
#include "network/yolox.h"

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

}  // namespace
}  // namespace windhover
