#include "network/opencv_engine.h"

#include <algorithm>
#include <stdexcept>

#include <opencv2/dnn.hpp>

namespace windhover {
namespace {

/// Reads the file by itself: of windhover's reading it takes the shapes and names alone.
class OpenCvEngine final : public InferenceEngine {
 public:
  OpenCvEngine(const InferenceTask& task, const std::string& onnx_file)
      : net_(cv::dnn::readNetFromONNX(onnx_file.data(), onnx_file.size())),
        batch_(static_cast<std::size_t>(task.batch)),
        input_(task.shapes.front()) {
    net_.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    net_.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    for (const int output : task.table.outputs) {
      const auto i = static_cast<std::size_t>(output);
      const LayerShape& shape = task.shapes[i];
      names_.push_back(NameInNet(task.table.layers[i].name));
      sizes_.push_back(static_cast<std::size_t>(shape.channels * shape.height * shape.width));
      outputs_.emplace_back(batch_ * sizes_.back());
    }
  }

  void Run(std::span<const float> images) override {
    const auto size = static_cast<std::size_t>(input_.channels * input_.height * input_.width);
    if (images.size() != batch_ * size) {
      throw std::invalid_argument("a network needs as many values as its input has");
    }
    for (std::size_t i = 0; i < batch_; ++i) RunOne(images.subspan(i * size, size), i);
  }

  std::span<const float> Output(std::size_t i) const override { return outputs_[i]; }

 private:
  void RunOne(std::span<const float> image, std::size_t index) {
    const int shape[] = {1, input_.channels, input_.height, input_.width};
    net_.setInput(cv::Mat(4, shape, CV_32F, const_cast<float*>(image.data())));
    std::vector<cv::Mat> results;
    net_.forward(results, names_);
    for (std::size_t k = 0; k < results.size(); ++k) {
      if (results[k].total() != sizes_[k]) throw std::runtime_error("a result of another size");
      const float* from = results[k].ptr<float>();
      std::copy(from, from + sizes_[k],
                outputs_[k].begin() + static_cast<std::ptrdiff_t>(index * sizes_[k]));
    }
  }

  /// OpenCV puts words of its own before the names of nodes and tensors.
  std::string NameInNet(const std::string& name) const {
    const std::vector<std::string> all = net_.getUnconnectedOutLayersNames();
    const auto found = std::find_if(all.begin(), all.end(), [&](const std::string& one) {
      return one.substr(one.find('!') + 1) == name;
    });
    if (found == all.end()) throw std::runtime_error("OpenCV finds no output " + name);
    return *found;
  }

  cv::dnn::Net net_;
  std::size_t batch_;
  LayerShape input_;
  std::vector<std::string> names_;
  std::vector<std::size_t> sizes_;  ///< Of each output, for one image.
  std::vector<std::vector<float>> outputs_;
};

}  // namespace

std::unique_ptr<InferenceEngine> MakeOpenCvEngine(const InferenceTask& task,
                                                  const std::string& onnx_file) {
  return std::make_unique<OpenCvEngine>(task, onnx_file);
}

}  // namespace windhover
