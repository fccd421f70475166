#include "network/onednn_engine.h"

#include <algorithm>
#include <stdexcept>
#include <unordered_map>

#include <omp.h>
#include <oneapi/dnnl/dnnl.hpp>

#include "common/cpu/instruction_set.h"

namespace windhover {
namespace {

using dnnl::memory;
using Dims = memory::dims;
using Tag = memory::format_tag;

constexpr auto kFloat = memory::data_type::f32;

/// Takes effect before the first primitive alone, for all of the process.
void LimitInstructions() {
  static const bool limited = [] {
    switch (WidestInstructionSet()) {
      case InstructionSet::kSse2:
        return dnnl::set_max_cpu_isa(dnnl::cpu_isa::sse41) == dnnl::status::success;
      case InstructionSet::kAvx2:
        return dnnl::set_max_cpu_isa(dnnl::cpu_isa::avx2) == dnnl::status::success;
      default:
        return true;
    }
  }();
  static_cast<void>(limited);  // Refused only once primitives exist: other code's choice.
}

/// OpenMP's threads as this thread starts them: one, until the end of the scope.
class OneThread {
 public:
  OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;

 private:
  int before_;
};

/// Layers as oneDNN's primitives in formats of its choice; weights are brought into theirs once.
class OneDnnEngine final : public InferenceEngine {
 public:
  explicit OneDnnEngine(const InferenceTask& task)
      : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
    const OneThread one_thread;
    const std::size_t n = task.table.layers.size();
    results_.resize(n);
    for (std::size_t i = 0; i < n; ++i) AddLayer(task, i);
    for (const int output : task.table.outputs) {
      const memory& result = results_[static_cast<std::size_t>(output)];
      outputs_.push_back(InFormat(result, {result.get_desc().dims(), kFloat, Tag::nchw}));
    }
  }

  void Run(std::span<const float> images) override {
    const OneThread one_thread;
    const memory& input = results_.front();
    if (images.size_bytes() != input.get_desc().get_size()) {
      throw std::invalid_argument("a network needs as many values as its input has");
    }
    std::copy(images.begin(), images.end(), static_cast<float*>(input.get_data_handle()));
    for (const Step& step : steps_) step.primitive.execute(stream_, step.arguments);
    stream_.wait();
  }

  std::span<const float> Output(std::size_t i) const override {
    const memory& output = outputs_[i];
    return {static_cast<const float*>(output.get_data_handle()),
            output.get_desc().get_size() / sizeof(float)};
  }

 private:
  struct Step {
    dnnl::primitive primitive;
    std::unordered_map<int, memory> arguments;
  };

  static Dims DimsOf(const InferenceTask& task, std::size_t layer) {
    const LayerShape& shape = task.shapes[layer];
    return {task.batch, shape.channels, shape.height, shape.width};
  }

  const memory& In(const Layer& layer, std::size_t i = 0) const {
    return results_[static_cast<std::size_t>(layer.inputs[i])];
  }

  void AddStep(dnnl::primitive primitive, std::unordered_map<int, memory> arguments) {
    steps_.push_back({std::move(primitive), std::move(arguments)});
  }

  /// `from`, or a copy in the format `to` that is made in every run.
  memory InFormat(const memory& from, const memory::desc& to) {
    if (from.get_desc() == to) return from;
    memory reordered(to, engine_);
    AddStep(dnnl::reorder(from, reordered), {{DNNL_ARG_FROM, from}, {DNNL_ARG_TO, reordered}});
    return reordered;
  }

  /// What was learned, in the format `to`, from now on.
  memory Learned(const std::vector<float>& values, const Dims& dims, Tag tag,
                 const memory::desc& to) {
    memory plain({dims, kFloat, tag}, engine_);
    std::copy(values.begin(), values.end(), static_cast<float*>(plain.get_data_handle()));
    memory learned(to, engine_);
    dnnl::reorder(plain, learned).execute(stream_, plain, learned);
    stream_.wait();
    return learned;
  }

  void AddLayer(const InferenceTask& task, std::size_t i) {
    switch (task.table.layers[i].kind) {
      case LayerKind::kInput:
        results_[i] = memory({DimsOf(task, i), kFloat, Tag::nchw}, engine_);
        return;
      case LayerKind::kConv:
        return AddConv(task, i);
      case LayerKind::kMaxPool:
        return AddMaxPool(task, i);
      case LayerKind::kUpsample:
        return AddUpsample(task, i);
      case LayerKind::kConcat:
        return AddConcat(task, i);
      case LayerKind::kAdd:
        return AddAdd(task, i);
    }
  }

  static dnnl::primitive_attr Fused(Activation activation) {
    dnnl::post_ops after;
    if (activation == Activation::kSilu) {
      after.append_eltwise(1, dnnl::algorithm::eltwise_swish, /*alpha=*/1, 0);
    } else if (activation == Activation::kRelu) {
      after.append_eltwise(1, dnnl::algorithm::eltwise_relu, 0, 0);
    }
    dnnl::primitive_attr attributes;
    attributes.set_post_ops(after);
    return attributes;
  }

  /// Padding after the last row or column, by which the shapes come out.
  static Dims PaddingAfter(const Layer& layer, const Dims& in, const Dims& out, int before) {
    const auto after = [&](std::size_t axis) {
      return (out[axis] - 1) * layer.stride + layer.kernel - in[axis] - before;
    };
    return {after(2), after(3)};
  }

  void AddConv(const InferenceTask& task, std::size_t i) {
    const Layer& layer = task.table.layers[i];
    const memory& in = In(layer);
    const Dims in_dims = in.get_desc().dims(), out_dims = DimsOf(task, i);
    const int before = (layer.kernel - 1) / 2, groups = layer.groups;
    const bool grouped = groups > 1;
    Dims weight_dims = {layer.channels / groups, in_dims[1] / groups, layer.kernel, layer.kernel};
    if (grouped) weight_dims.insert(weight_dims.begin(), groups);
    // The first convolution reads the image as it comes; all others what suits them.
    const Tag in_tag = layer.inputs.front() == 0 ? Tag::nchw : Tag::any;
    const dnnl::convolution_forward::desc desc(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct,
        {in_dims, kFloat, in_tag}, {weight_dims, kFloat, Tag::any},
        {{layer.channels}, kFloat, Tag::x}, {out_dims, kFloat, Tag::any},
        {layer.stride, layer.stride}, {before, before},
        PaddingAfter(layer, in_dims, out_dims, before));
    const dnnl::convolution_forward::primitive_desc chosen(desc, Fused(layer.activation), engine_);
    const ConvWeights& learned = task.weights.layers[i];
    const memory source = InFormat(in, chosen.src_desc());
    results_[i] = memory(chosen.dst_desc(), engine_);
    AddStep(dnnl::convolution_forward(chosen),
            {{DNNL_ARG_SRC, source},
             {DNNL_ARG_WEIGHTS, Learned(learned.weight, weight_dims,
                                        grouped ? Tag::goihw : Tag::oihw, chosen.weights_desc())},
             {DNNL_ARG_BIAS, Learned(learned.bias, {layer.channels}, Tag::x, chosen.bias_desc())},
             {DNNL_ARG_DST, results_[i]}});
  }

  void AddMaxPool(const InferenceTask& task, std::size_t i) {
    const Layer& layer = task.table.layers[i];
    const memory& in = In(layer);
    const Dims out_dims = DimsOf(task, i);
    const int before = (layer.kernel - 1) / 2;
    const dnnl::pooling_forward::desc desc(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::pooling_max, in.get_desc(),
        {out_dims, kFloat, Tag::any}, {layer.stride, layer.stride}, {layer.kernel, layer.kernel},
        {before, before}, PaddingAfter(layer, in.get_desc().dims(), out_dims, before));
    const dnnl::pooling_forward::primitive_desc chosen(desc, engine_);
    results_[i] = memory(chosen.dst_desc(), engine_);
    AddStep(dnnl::pooling_forward(chosen), {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, results_[i]}});
  }

  void AddUpsample(const InferenceTask& task, std::size_t i) {
    const memory& in = In(task.table.layers[i]);
    const dnnl::resampling_forward::desc desc(dnnl::prop_kind::forward_inference,
                                              dnnl::algorithm::resampling_nearest, {2.f, 2.f},
                                              in.get_desc(), {DimsOf(task, i), kFloat, Tag::any});
    const dnnl::resampling_forward::primitive_desc chosen(desc, engine_);
    results_[i] = memory(chosen.dst_desc(), engine_);
    AddStep(dnnl::resampling_forward(chosen), {{DNNL_ARG_SRC, in}, {DNNL_ARG_DST, results_[i]}});
  }

  void AddConcat(const InferenceTask& task, std::size_t i) {
    const Layer& layer = task.table.layers[i];
    std::vector<memory::desc> descs;
    for (const int input : layer.inputs) {
      descs.push_back(results_[static_cast<std::size_t>(input)].get_desc());
    }
    const dnnl::concat::primitive_desc chosen(/*concat_dimension=*/1, descs, engine_);
    results_[i] = memory(chosen.dst_desc(), engine_);
    std::unordered_map<int, memory> arguments = {{DNNL_ARG_DST, results_[i]}};
    for (std::size_t k = 0; k < layer.inputs.size(); ++k) {
      arguments[DNNL_ARG_MULTIPLE_SRC + static_cast<int>(k)] = In(layer, k);
    }
    AddStep(dnnl::concat(chosen), std::move(arguments));
  }

  void AddAdd(const InferenceTask& task, std::size_t i) {
    const Layer& layer = task.table.layers[i];
    memory sum = In(layer);
    for (std::size_t k = 1; k < layer.inputs.size(); ++k) {
      const memory other = InFormat(In(layer, k), sum.get_desc());
      memory next(sum.get_desc(), engine_);
      const dnnl::binary::desc desc(dnnl::algorithm::binary_add, sum.get_desc(), other.get_desc(),
                                    next.get_desc());
      AddStep(dnnl::binary(dnnl::binary::primitive_desc(desc, engine_)),
              {{DNNL_ARG_SRC_0, sum}, {DNNL_ARG_SRC_1, other}, {DNNL_ARG_DST, next}});
      sum = next;
    }
    results_[i] = sum;
  }

  dnnl::engine engine_;
  dnnl::stream stream_;
  std::vector<memory> results_;  ///< Of every layer.
  std::vector<memory> outputs_;
  std::vector<Step> steps_;
};

}  // namespace

std::unique_ptr<InferenceEngine> MakeOneDnnEngine(const InferenceTask& task) {
  LimitInstructions();
  return std::make_unique<OneDnnEngine>(task);
}

}  // namespace windhover
