#include "learn/pcm_onnx.h"

#include <numbers>

#include "estimator/mixer_pass.h"
#include "network/onnx_writer.h"

namespace windhover {
namespace {

constexpr int kSides = 2, kRows = kSides * kBoxTokens;  // A row is a token of a side.
using Tensor = OnnxWriter::Tensor;

/// Adds the layers of a mixer to a graph. Parameters are taken in the order of MixerLayout.
class MixerGraph {
 public:
  MixerGraph(const Mixer& mixer, OnnxWriter* writer)
      : width_(mixer.width()), next_(mixer.parameters().data()), writer_(*writer) {
    half_ = writer_.Constant(0.5f);
    one_ = writer_.Constant(1.0f);
    inverse_sqrt2_ = writer_.Constant(std::numbers::sqrt2_v<float> / 2);
    epsilon_ = writer_.Constant(1e-5f);
    ones_ = writer_.Constant(1.0f, {1, width_});
  }

  /// y = x A + b for rows x; torch keeps A output by output, ONNX input by input.
  Tensor Linear(const Tensor& x, const std::string& name, int n_in, int n_out) {
    std::vector<float> weight(static_cast<std::size_t>(n_in * n_out));
    for (int o = 0; o < n_out; ++o) {
      for (int i = 0; i < n_in; ++i) weight[static_cast<std::size_t>(i * n_out + o)] = *next_++;
    }
    const Tensor a = writer_.Parameter(name + ".weight", {n_in, n_out}, weight);
    return writer_.Apply("Add", {writer_.Apply("MatMul", {x, a}), Next(name + ".bias", n_out)});
  }

  /// Layer norm over the channels of each row.
  Tensor Norm(const Tensor& x, const std::string& name) {
    // Spread by hand: not every reader broadcasts in Sub (OpenCV 4.6 does not).
    const Tensor mean = writer_.Apply("MatMul", {MeanOfRow(x), ones_});
    const Tensor off = writer_.Apply("Sub", {x, mean});
    const Tensor variance = MeanOfRow(writer_.Apply("Mul", {off, off}));
    const Tensor sigma = writer_.Apply("Sqrt", {writer_.Apply("Add", {variance, epsilon_})});
    const Tensor unit = writer_.Apply("Div", {off, sigma});
    const Tensor weight = Next(name + ".weight", width_), bias = Next(name + ".bias", width_);
    return writer_.Apply("Add", {writer_.Apply("Mul", {unit, weight}), bias});
  }

  /// Two layers across the tokens, alike for every channel.
  Tensor MixTokens(const Tensor& x, const std::string& name) {
    constexpr int kHidden = MixerLayout<4>::kTokenHidden;
    const Tensor columns = Transposed(x, kBoxTokens, width_);
    const Tensor hidden = Gelu(Linear(columns, name + ".in", kBoxTokens, kHidden));
    return Transposed(Linear(hidden, name + ".out", kHidden, kBoxTokens), width_, kBoxTokens);
  }

  /// Two layers across the channels, alike for every token.
  Tensor MixChannels(const Tensor& x, const std::string& name) {
    const Tensor hidden = Gelu(Linear(x, name + ".in", width_, width_ / 2));
    return Linear(hidden, name + ".out", width_ / 2, width_);
  }

  Tensor MeanOfTokens(const Tensor& x) {
    const Tensor sides = writer_.Reshape(x, {kSides, kBoxTokens, width_});
    return writer_.Apply("ReduceMean", {sides}, {{"axes", {1}}, {"keepdims", 0}});
  }

 private:
  Tensor Next(const std::string& name, int n) {
    const std::span<const float> values(next_, static_cast<std::size_t>(n));
    next_ += n;
    return writer_.Parameter(name, {n}, values);
  }

  Tensor MeanOfRow(const Tensor& x) {
    return writer_.Apply("ReduceMean", {x}, {{"axes", {1}}, {"keepdims", 1}});
  }

  /// Rows and columns of each side exchanged.
  Tensor Transposed(const Tensor& x, int rows, int columns) {
    const Tensor sides = writer_.Reshape(x, {kSides, rows, columns});
    const Tensor exchanged = writer_.Apply("Transpose", {sides}, {{"perm", {0, 2, 1}}});
    return writer_.Reshape(exchanged, {kSides * columns, rows});
  }

  /// x (1 + erf(x / √2)) / 2
  Tensor Gelu(const Tensor& x) {
    const Tensor erf = writer_.Apply("Erf", {writer_.Apply("Mul", {x, inverse_sqrt2_})});
    const Tensor twice = writer_.Apply("Mul", {x, writer_.Apply("Add", {erf, one_})});
    return writer_.Apply("Mul", {twice, half_});
  }

  int width_;
  const float* next_;
  OnnxWriter& writer_;
  Tensor half_, one_, inverse_sqrt2_, epsilon_, ones_;
};

}  // namespace

std::string MixerOnnx(const Mixer& mixer) {
  OnnxWriter writer;
  const Tensor tokens = writer.Input("tokens", {kSides, kBoxTokens});
  MixerGraph graph(mixer, &writer);
  Tensor x = graph.Linear(writer.Reshape(tokens, {kRows, 1}), "embedding", 1, mixer.width());
  for (int b = 0; b < MixerLayout<4>::kBlocks; ++b) {
    const std::string block = "block" + std::to_string(b);
    const Tensor between = graph.MixTokens(graph.Norm(x, block + ".token_norm"), block + ".token");
    x = writer.Apply("Add", {x, between});
    const Tensor within =
        graph.MixChannels(graph.Norm(x, block + ".channel_norm"), block + ".channel");
    x = writer.Apply("Add", {x, within});
  }
  x = graph.MeanOfTokens(graph.Norm(x, "last_norm"));
  x = graph.Linear(x, "head", mixer.width(), mixer.n_outputs());
  const bool is_gate = mixer.n_outputs() == 2;
  writer.Output(is_gate ? x : writer.Apply("Tanh", {x}), is_gate ? "logits" : "offsets",
                {kSides, mixer.n_outputs()});
  return writer.Model(is_gate ? "gate" : "pcm");
}

std::vector<NamedModel> PcmOnnx(const PcmStages& stages) {
  std::vector<NamedModel> models;
  for (std::size_t i = 0; i < stages.offsets.size(); ++i) {
    models.push_back({"offset" + std::to_string(i), MixerOnnx(stages.offsets[i])});
    if (i < stages.gates.size()) {
      models.push_back({"gate" + std::to_string(i), MixerOnnx(stages.gates[i])});
    }
  }
  if (stages.alone) models.push_back({"alone", MixerOnnx(*stages.alone)});
  return models;
}

}  // namespace windhover
