#include "network/yolox.h"

#include <array>
#include <stdexcept>

namespace windhover {
namespace {

struct Size {
  int width;  ///< Channels of the stem; each stage of the backbone has twice those before it.
  bool depthwise;
  Activation activation;
  int head_convs = 2;  ///< In each branch of a head.
};

constexpr int kStages = 4;                                   // Strides 4, 8, 16, 32.
constexpr std::array<int, kStages> kRepeats = {1, 3, 3, 1};  // At depth 0.33.
constexpr std::array<int, 3> kSppKernels = {5, 9, 13};
constexpr int kBoxNumbers = 4, kClasses = 1;

/// Adds the blocks of a YOLOX to a table. A block takes and gives the index of a layer.
class YoloxBuilder {
 public:
  YoloxBuilder(const Size& size, LayerTable* table) : size_(size), table_(*table) {
    Add({.kind = LayerKind::kInput, .name = "images", .inputs = {}, .channels = 3});
  }

  void Build() {
    const std::array<int, 3> features = Backbone();
    const std::array<int, 3> levels = Neck(features);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      table_.outputs.push_back(Head("head" + std::to_string(i), levels[i]));
    }
  }

 private:
  int Add(Layer layer) {
    table_.layers.push_back(std::move(layer));
    return static_cast<int>(table_.layers.size()) - 1;
  }

  int ChannelsOf(int index) const {
    return table_.layers[static_cast<std::size_t>(index)].channels;
  }

  /// Convolution, batch normalisation, activation.
  int BaseConv(const std::string& name, int in, int channels, int kernel, int stride = 1,
               int groups = 1) {
    return Add({.kind = LayerKind::kConv,
                .name = name,
                .inputs = {in},
                .channels = channels,
                .kernel = kernel,
                .stride = stride,
                .groups = groups,
                .activation = size_.activation,
                .batch_norm = true});
  }

  /// 3 × 3; in depthwise networks a depthwise one and a 1 × 1.
  int Conv(const std::string& name, int in, int channels, int stride = 1) {
    if (!size_.depthwise) return BaseConv(name, in, channels, 3, stride);
    const int depthwise = BaseConv(name + ".dconv", in, ChannelsOf(in), 3, stride, ChannelsOf(in));
    return BaseConv(name + ".pconv", depthwise, channels, 1);
  }

  int Concat(const std::string& name, std::vector<int> inputs) {
    int channels = 0;
    for (const int input : inputs) channels += ChannelsOf(input);
    return Add({.kind = LayerKind::kConcat,
                .name = name,
                .inputs = std::move(inputs),
                .channels = channels});
  }

  int Upsample(const std::string& name, int in) {
    return Add(
        {.kind = LayerKind::kUpsample, .name = name, .inputs = {in}, .channels = ChannelsOf(in)});
  }

  int Bottleneck(const std::string& name, int in, bool shortcut) {
    const int channels = ChannelsOf(in);
    const int out = Conv(name + ".conv2", BaseConv(name + ".conv1", in, channels, 1), channels);
    if (!shortcut) return out;
    return Add({.kind = LayerKind::kAdd,
                .name = name + ".add",
                .inputs = {out, in},
                .channels = channels});
  }

  /// Cross-stage partial: half of the channels go through the bottlenecks.
  int Csp(const std::string& name, int in, int channels, int repeats, bool shortcut) {
    int deep = BaseConv(name + ".conv1", in, channels / 2, 1);
    const int past = BaseConv(name + ".conv2", in, channels / 2, 1);
    for (int i = 0; i < repeats; ++i) {
      deep = Bottleneck(name + ".m" + std::to_string(i), deep, shortcut);
    }
    return BaseConv(name + ".conv3", Concat(name + ".concat", {deep, past}), channels, 1);
  }

  /// Spatial pyramid pooling.
  int Spp(const std::string& name, int in) {
    const int half = BaseConv(name + ".conv1", in, ChannelsOf(in) / 2, 1);
    std::vector<int> pyramid = {half};
    for (const int kernel : kSppKernels) {
      pyramid.push_back(Add({.kind = LayerKind::kMaxPool,
                             .name = name + ".pool" + std::to_string(kernel),
                             .inputs = {half},
                             .channels = ChannelsOf(half),
                             .kernel = kernel}));
    }
    return BaseConv(name + ".conv2", Concat(name + ".concat", pyramid), ChannelsOf(in), 1);
  }

  /// @return features at strides 8, 16, 32.
  std::array<int, 3> Backbone() {
    std::array<int, 3> features{};
    // YOLOX's Focus (space to depth, then 3 × 3) is one 6 × 6 convolution of stride 2.
    int x = BaseConv("stem", 0, size_.width, 6, 2);
    for (int stage = 0; stage < kStages; ++stage) {
      const std::string name = "dark" + std::to_string(stage + 2);
      const bool last = stage == kStages - 1;
      x = Conv(name + ".conv", x, 2 * ChannelsOf(x), 2);
      if (last) x = Spp(name + ".spp", x);
      x = Csp(name + ".csp", x, ChannelsOf(x), kRepeats[static_cast<std::size_t>(stage)], !last);
      if (stage > 0) features[static_cast<std::size_t>(stage - 1)] = x;
    }
    return features;
  }

  /// Path aggregation: features go down to the finest level and up again.
  std::array<int, 3> Neck(const std::array<int, 3>& f) {
    const auto csp = [&](const std::string& name, int a, int b, int channels) {
      return Csp(name, Concat(name + ".in", {a, b}), channels, 1, false);
    };
    const int c8 = ChannelsOf(f[0]), c16 = ChannelsOf(f[1]), c32 = ChannelsOf(f[2]);
    const int lateral32 = BaseConv("neck.lateral32", f[2], c16, 1);
    const int down16 = csp("neck.down16", Upsample("neck.up32", lateral32), f[1], c16);
    const int lateral16 = BaseConv("neck.lateral16", down16, c8, 1);
    const int out8 = csp("neck.down8", Upsample("neck.up16", lateral16), f[0], c8);
    const int out16 = csp("neck.out16", Conv("neck.conv8", out8, c8, 2), lateral16, c16);
    const int out32 = csp("neck.out32", Conv("neck.conv16", out16, c16, 2), lateral32, c32);
    return {out8, out16, out32};
  }

  int Prediction(const std::string& name, int in, int channels) {
    return Add({.kind = LayerKind::kConv, .name = name, .inputs = {in}, .channels = channels});
  }

  /// Decoupled: a branch for box and objectness, and one for the class.
  int Head(const std::string& name, int in) {
    const int channels = 4 * size_.width;
    const int stem = BaseConv(name + ".stem", in, channels, 1);
    const auto branch = [&](const std::string& what) {
      int x = stem;
      for (int i = 0; i < size_.head_convs; ++i) {
        x = Conv(name + what + std::to_string(i), x, channels);
      }
      return x;
    };
    const int reg = branch(".reg"), cls = branch(".cls");
    const int box = Prediction(name + ".box_obj", reg, kBoxNumbers + 1);
    return Concat(name, {box, Prediction(name + ".class", cls, kClasses)});
  }

  Size size_;
  LayerTable& table_;
};

}  // namespace

YoloxNetwork MakeYolox(const std::string& name) {
  YoloxNetwork network{
      .name = name, .height = 192, .width = 352, .strides = {8, 16, 32}, .table = {}};
  Size size{.width = 8, .depthwise = false, .activation = Activation::kRelu};
  if (name == "yolox_nano") {
    size = {.width = 16, .depthwise = true, .activation = Activation::kSilu};
  } else if (name == "yolox_refine") {
    network.height = network.width = 128;
  } else if (name == "yolox_small") {
    size.head_convs = 1;
  } else {
    throw std::invalid_argument("no network is called " + name);
  }
  network.table.name = name;
  YoloxBuilder(size, &network.table).Build();
  return network;
}

}  // namespace windhover
