// What trained detectors cost, with random weights: the time does not depend on what was learned.

#include <benchmark/benchmark.h>

#include "common/random/random_stream.h"
#include "network/detector_input.h"
#include "network/inference.h"
#include "network/network_onnx.h"
#include "network/yolox.h"

namespace windhover {
namespace {

cv::Mat RandomImage(cv::Size size) {
  RandomStream stream(1, "image");
  cv::Mat image(size, CV_8UC3);
  for (std::size_t i = 0; i < 3 * image.total(); ++i) {
    image.data[i] = static_cast<std::uint8_t>(256 * stream.Uniform());
  }
  return image;
}

void BM_Window(benchmark::State& state, double side_px) {
  const cv::Mat image = RandomImage({1280, 720});
  image_box_t box{};
  box.x_px = 640;
  box.y_px = 360;
  box.w_px = side_px;
  const InputWindow window =
      side_px == 0 ? LetterboxWindow(image.size(), {352, 192}) : CropWindow(box, 2, {128, 128});
  std::vector<float> planes(3 * static_cast<std::size_t>(window.size.area()));
  for (auto unused : state) {
    const cv::Mat seen = SeenThrough(window, image);
    ToPlanes(seen, planes);
    benchmark::DoNotOptimize(planes.data());
  }
}
BENCHMARK_CAPTURE(BM_Window, letterbox, 0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Window, crop_of_30_px, 30)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Window, crop_of_200_px, 200)->Unit(benchmark::kMillisecond);

/// Of both images of a pair.
void BM_Network(benchmark::State& state, const char* name, bool fast) {
  const YoloxNetwork network = MakeYolox(name);
  const NetworkWeights weights = RandomWeights(network.table, 1);
  const InferenceTask task{network.table, weights,
                           ShapesOf(network.table, network.height, network.width), 2};
  const auto engine =
      fast ? Inference().make_onednn(task)
           : Inference().make_opencv(
                 task, NetworkOnnx(network.table, weights, network.height, network.width));
  const std::vector<float> images(static_cast<std::size_t>(2 * 3 * network.height * network.width),
                                  0.5f);
  for (auto unused : state) engine->Run(images);
}
BENCHMARK_CAPTURE(BM_Network, nano_onednn, "yolox_nano", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Network, small_onednn, "yolox_small", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Network, refine_onednn, "yolox_refine", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Network, nano_opencv, "yolox_nano", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Network, small_opencv, "yolox_small", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Network, refine_opencv, "yolox_refine", false)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace windhover

BENCHMARK_MAIN();
