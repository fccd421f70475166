#include "network/network_onnx.h"

#include <array>

#include "network/onnx_writer.h"

namespace windhover {
namespace {

using Tensor = OnnxWriter::Tensor;

class NetworkGraph {
 public:
  NetworkGraph(const LayerTable& table, OnnxWriter* writer) : table_(table), writer_(*writer) {}

  void Add(const Layer& layer, const ConvWeights& weights, const LayerShape& shape) {
    tensors_.push_back(layer.kind == LayerKind::kInput  ? writer_.Input(layer.name, Batch(shape))
                       : layer.kind == LayerKind::kConv ? Conv(layer, weights)
                                                        : Other(layer));
  }

  void Output(int index, const LayerShape& shape) {
    const auto i = static_cast<std::size_t>(index);
    writer_.Output(tensors_[i], table_.layers[i].name, Batch(shape));
  }

 private:
  static OnnxShape Batch(const LayerShape& shape) {
    return {1, shape.channels, shape.height, shape.width};
  }

  Tensor In(const Layer& layer) const {
    return tensors_[static_cast<std::size_t>(layer.inputs.front())];
  }

  std::vector<OnnxWriter::Attribute> Window(const Layer& layer) const {
    const int k = layer.kernel, s = layer.stride, p = (k - 1) / 2;
    return {{"kernel_shape", {k, k}}, {"strides", {s, s}}, {"pads", {p, p, p, p}}};
  }

  Tensor Conv(const Layer& layer, const ConvWeights& weights) {
    const OnnxShape shape = {layer.channels, InputChannels(table_, layer) / layer.groups,
                             layer.kernel, layer.kernel};
    const Tensor weight = writer_.Parameter(layer.name + ".weight", shape, weights.weight);
    const Tensor bias = writer_.Parameter(layer.name + ".bias", {layer.channels}, weights.bias);
    auto attributes = Window(layer);
    attributes.push_back({"group", layer.groups});
    const Tensor x = writer_.Apply("Conv", {In(layer), weight, bias}, attributes);
    if (layer.activation == Activation::kRelu) return writer_.Apply("Relu", {x});
    if (layer.activation == Activation::kNone) return x;
    return writer_.Apply("Mul", {x, writer_.Apply("Sigmoid", {x})});
  }

  Tensor Upsampled(const Tensor& x) {
    if (scales_.empty()) {
      scales_ = writer_.Parameter("upsample.scales", {4}, std::array{1.f, 1.f, 2.f, 2.f});
    }
    return writer_.Apply("Resize", {x, "", scales_},
                         {{"mode", "nearest"},
                          {"coordinate_transformation_mode", "asymmetric"},
                          {"nearest_mode", "floor"}});
  }

  Tensor Other(const Layer& layer) {
    if (layer.kind == LayerKind::kMaxPool) {
      return writer_.Apply("MaxPool", {In(layer)}, Window(layer));
    }
    if (layer.kind == LayerKind::kUpsample) return Upsampled(In(layer));
    std::vector<Tensor> inputs;
    for (const int i : layer.inputs) inputs.push_back(tensors_[static_cast<std::size_t>(i)]);
    if (layer.kind == LayerKind::kConcat) return writer_.Apply("Concat", inputs, {{"axis", 1}});
    Tensor sum = inputs.front();
    for (std::size_t i = 1; i < inputs.size(); ++i) sum = writer_.Apply("Add", {sum, inputs[i]});
    return sum;
  }

  const LayerTable& table_;
  OnnxWriter& writer_;
  std::vector<Tensor> tensors_;
  Tensor scales_;
};

}  // namespace

std::string NetworkOnnx(const LayerTable& table, const NetworkWeights& weights, int height,
                        int width) {
  const std::vector<LayerShape> shapes = ShapesOf(table, height, width);
  CheckWeights(table, weights);
  OnnxWriter writer;
  NetworkGraph graph(table, &writer);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    graph.Add(table.layers[i], weights.layers[i], shapes[i]);
  }
  for (const int output : table.outputs) {
    graph.Output(output, shapes[static_cast<std::size_t>(output)]);
  }
  return writer.Model(table.name);
}

}  // namespace windhover
