#include "network/box_network.h"

#include <stdexcept>

namespace windhover {
namespace {

std::unique_ptr<InferenceEngine> MakeEngine(const NetworkModel& model,
                                            const std::vector<LayerShape>& shapes, int batch,
                                            EngineKind kind) {
  const InferenceTask task{model.table, model.weights, shapes, batch};
  return kind == EngineKind::kOneDnn ? Inference().make_onednn(task)
                                     : Inference().make_opencv(task, model.onnx_file);
}

}  // namespace

BoxNetwork::BoxNetwork(NetworkModel model, int batch, EngineKind kind)
    : model_(std::move(model)),
      shapes_(ShapesOf(model_.table, model_.height, model_.width)),
      batch_(static_cast<std::size_t>(batch)),
      engine_(MakeEngine(model_, shapes_, batch, kind)),
      images_(batch_ * 3 * static_cast<std::size_t>(input().area())) {
  // Engines have what they need.
  model_.weights = {};
  model_.onnx_file.clear();
}

std::vector<std::vector<ScoredBox>> BoxNetwork::Find(std::span<const View> views,
                                                     double min_score) {
  if (views.size() != batch_) throw std::invalid_argument("as many views as the batch has");
  const std::size_t size = images_.size() / batch_;
  for (std::size_t i = 0; i < batch_; ++i) {
    ToPlanes(SeenThrough(views[i].window, views[i].rgb),
             std::span(images_).subspan(i * size, size));
  }
  engine_->Run(images_);
  std::vector<std::vector<ScoredBox>> all;
  for (std::size_t i = 0; i < batch_; ++i) {
    std::vector<YoloxLevel> levels;
    for (std::size_t k = 0; k < model_.table.outputs.size(); ++k) {
      const LayerShape& shape = shapes_[static_cast<std::size_t>(model_.table.outputs[k])];
      const std::span<const float> output = engine_->Output(k);
      levels.push_back(
          {.values = output.subspan(i * (output.size() / batch_), output.size() / batch_),
           .height = shape.height,
           .width = shape.width,
           .stride = model_.height / shape.height});
    }
    std::vector<ScoredBox> boxes = DecodeBoxes(levels, min_score);
    for (ScoredBox& box : boxes) box.box = views[i].window.ToImage(box.box);
    all.push_back(std::move(boxes));
  }
  return all;
}

std::vector<std::vector<ScoredBox>> BoxNetwork::FindInWhole(std::span<const cv::Mat> images,
                                                            double min_score) {
  std::vector<View> views;
  for (const cv::Mat& image : images) {
    views.push_back({image, LetterboxWindow(image.size(), input())});
  }
  auto found = Find(views, min_score);
  for (auto& boxes : found) boxes = WithoutDoubles(std::move(boxes), kMaxOverlap, kMaxTargets);
  return found;
}

}  // namespace windhover
