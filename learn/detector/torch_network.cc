#include "learn/detector/torch_network.h"

#include <stdexcept>

#include <torch/torch.h>

#include "network/detector_input.h"

namespace windhover {
namespace {

constexpr double kNormMomentum = 0.03;  // Of running statistics, as YOLOX's.

torch::Tensor Activated(const torch::Tensor& x, Activation activation) {
  if (activation == Activation::kRelu) return torch::relu(x);
  return activation == Activation::kSilu ? torch::silu(x) : x;
}

/// RGB, 0..1, N × 3 × H × W, stored pixel by pixel: oneDNN's fast order.
torch::Tensor ImagesOf(std::span<const DetectorSample> batch) {
  if (batch.empty()) throw std::invalid_argument("an empty batch");
  const cv::Size size = batch.front().rgb.size();
  const auto n = static_cast<std::int64_t>(batch.size());
  torch::Tensor images = torch::empty({n, 3, size.height, size.width});
  const auto length = static_cast<std::size_t>(3 * size.area());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (batch[i].rgb.size() != size) throw std::invalid_argument("images of several sizes");
    ToPlanes(batch[i].rgb, {images.data_ptr<float>() + i * length, length});
  }
  return images.contiguous(at::MemoryFormat::ChannelsLast);
}

/// `tensor`'s numbers from or to plain ones in its logical order.
void Read(const float* from, torch::Tensor tensor) {
  tensor.copy_(torch::from_blob(const_cast<float*>(from), tensor.sizes()));
}
void Write(const torch::Tensor& tensor, float* to) {
  torch::from_blob(to, tensor.sizes()).copy_(tensor);
}

std::vector<std::int64_t> Pair(int value) { return {value, value}; }

}  // namespace

class TorchNetwork::Impl {
 public:
  explicit Impl(const YoloxNetwork& network)
      : network_(network), places_(PlacesOf(network.table)), tensors_(places_.size()) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (network.table.layers[i].kind == LayerKind::kConv) tensors_[i] = MakeTensors(i);
    }
  }

  void Take(const LearnedNetwork& numbers) {
    torch::NoGradGuard no_gradient;
    ForEach([&](ConvTensors& own, const ParameterPlace& place) {
      const auto channels = own.after.numel();
      Read(numbers.parameters.data() + place.weight, own.weight);
      Read(numbers.parameters.data() + place.after_weight, own.after);
      if (!own.beta.defined()) return;
      Read(numbers.parameters.data() + place.after_weight + channels, own.beta);
      Read(numbers.statistics.data() + place.mean, own.mean);
      Read(numbers.statistics.data() + place.mean + channels, own.variance);
    });
  }

  void GiveGradient(std::vector<float>* gradient) {
    ForEach([&](ConvTensors& own, const ParameterPlace& place) {
      const auto channels = own.after.numel();
      Write(own.weight.grad(), gradient->data() + place.weight);
      Write(own.after.grad(), gradient->data() + place.after_weight);
      own.weight.mutable_grad().reset();
      own.after.mutable_grad().reset();
      if (!own.beta.defined()) return;
      Write(own.beta.grad(), gradient->data() + place.after_weight + channels);
      own.beta.mutable_grad().reset();
    });
  }

  void GiveStatistics(std::vector<float>* statistics) {
    ForEach([&](ConvTensors& own, const ParameterPlace& place) {
      if (!own.beta.defined()) return;
      Write(own.mean, statistics->data() + place.mean);
      Write(own.variance, statistics->data() + place.mean + own.mean.numel());
    });
  }

  std::vector<torch::Tensor> Forward(const torch::Tensor& images, bool learning) {
    std::vector<torch::Tensor> maps = {images};
    for (std::size_t i = 1; i < places_.size(); ++i) maps.push_back(Apply(i, maps, learning));
    std::vector<torch::Tensor> outputs;
    for (const int i : network_.table.outputs) outputs.push_back(maps[static_cast<std::size_t>(i)]);
    return outputs;
  }

  const std::vector<int>& strides() const { return network_.strides; }

 private:
  struct ConvTensors {
    torch::Tensor weight, after, beta, mean, variance;  ///< `after`: gamma or bias.
  };

  template <typename Action>
  void ForEach(const Action& action) {
    for (std::size_t i = 0; i < tensors_.size(); ++i) {
      if (tensors_[i].weight.defined()) action(tensors_[i], places_[i]);
    }
  }

  ConvTensors MakeTensors(std::size_t i) const {
    const LayerTable& table = network_.table;
    const Layer& layer = table.layers[i];
    ConvTensors own;
    own.weight = torch::zeros({layer.channels, InputChannels(table, layer) / layer.groups,
                               layer.kernel, layer.kernel})
                     .contiguous(at::MemoryFormat::ChannelsLast)
                     .requires_grad_();
    own.after = torch::zeros({layer.channels}).requires_grad_();
    if (!layer.batch_norm) return own;
    own.beta = torch::zeros({layer.channels}).requires_grad_();
    own.mean = torch::zeros({layer.channels});
    own.variance = torch::ones({layer.channels});
    return own;
  }

  torch::Tensor Conv(const Layer& layer, const ConvTensors& own, const torch::Tensor& x,
                     bool learning) const {
    const torch::Tensor bias = layer.batch_norm ? torch::Tensor() : own.after;
    const auto y = torch::conv2d(x, own.weight, bias, Pair(layer.stride),
                                 Pair((layer.kernel - 1) / 2), Pair(1), layer.groups);
    if (!layer.batch_norm) return Activated(y, layer.activation);
    return Activated(torch::batch_norm(y, own.after, own.beta, own.mean, own.variance, learning,
                                       kNormMomentum, kNormEpsilon, false),
                     layer.activation);
  }

  torch::Tensor Apply(std::size_t i, const std::vector<torch::Tensor>& maps, bool learning) const {
    const Layer& layer = network_.table.layers[i];
    std::vector<torch::Tensor> in;
    for (const int input : layer.inputs) in.push_back(maps[static_cast<std::size_t>(input)]);
    switch (layer.kind) {
      case LayerKind::kConv:
        return Conv(layer, tensors_[i], in[0], learning);
      case LayerKind::kMaxPool:
        return torch::max_pool2d(in[0], Pair(layer.kernel), Pair(layer.stride),
                                 Pair((layer.kernel - 1) / 2));
      case LayerKind::kUpsample:
        return torch::upsample_nearest2d(in[0], {2 * in[0].size(2), 2 * in[0].size(3)});
      case LayerKind::kConcat:
        return torch::cat(in, 1);
      default:
        return in[0] + in[1];
    }
  }

  YoloxNetwork network_;
  std::vector<ParameterPlace> places_;
  std::vector<ConvTensors> tensors_;
};

TorchNetwork::TorchNetwork(const YoloxNetwork& network) : impl_(std::make_unique<Impl>(network)) {}
TorchNetwork::~TorchNetwork() = default;

YoloxLossParts TorchNetwork::Gradient(std::span<const DetectorSample> batch,
                                      LearnedNetwork* network, std::vector<float>* gradient) {
  at::set_num_threads(1);  // Of the calling thread; libtorch's own threads are slower here.
  impl_->Take(*network);
  std::vector<torch::Tensor> raw, by_raw;
  std::vector<LevelOutput> levels;
  const auto outputs = impl_->Forward(ImagesOf(batch), true);
  for (std::size_t l = 0; l < outputs.size(); ++l) {
    raw.push_back(outputs[l].detach().contiguous());
    by_raw.push_back(torch::empty_like(raw[l]));
    const auto size = static_cast<std::size_t>(raw[l].numel());
    levels.push_back({impl_->strides()[l],
                      static_cast<int>(raw[l].size(2)),
                      static_cast<int>(raw[l].size(3)),
                      {raw[l].data_ptr<float>(), size},
                      {by_raw[l].data_ptr<float>(), size}});
  }
  std::vector<std::optional<image_box_t>> targets;
  for (const DetectorSample& sample : batch) targets.push_back(sample.box);
  const YoloxLossParts parts = YoloxLoss(levels, targets);
  torch::autograd::backward(outputs, by_raw);
  gradient->resize(network->parameters.size());
  impl_->GiveGradient(gradient);
  impl_->GiveStatistics(&network->statistics);
  return parts;
}

std::vector<std::vector<float>> TorchNetwork::Outputs(std::span<const DetectorSample> batch,
                                                      const LearnedNetwork& network) {
  torch::NoGradGuard no_gradient;
  at::set_num_threads(1);
  impl_->Take(network);
  std::vector<std::vector<float>> outputs;
  for (const torch::Tensor& output : impl_->Forward(ImagesOf(batch), false)) {
    const torch::Tensor raw = output.contiguous();
    outputs.emplace_back(raw.data_ptr<float>(), raw.data_ptr<float>() + raw.numel());
  }
  return outputs;
}

}  // namespace windhover
