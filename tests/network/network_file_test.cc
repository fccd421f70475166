#include "network/network_file.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/config/fields.h"
#include "common/file/sha256.h"
#include "common/random/random_stream.h"
#include "network/detector_card.h"
#include "network/inference.h"
#include "network/network_onnx.h"
#include "network/onnx_writer.h"
#include "network/yolox.h"
#include "tests/support/temporary_folder.h"

namespace windhover {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string MessageOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

std::string MessageOf(const std::string& onnx) {
  return MessageOf([&] { ParseNetwork(onnx, "net.onnx"); });
}

/// A network of one convolution, as far as `spoil` leaves it one.
struct OneConv {
  OnnxShape input = {1, 3, 32, 64}, weight = {4, 3, 3, 3}, bias = {4};
  std::vector<OnnxWriter::Attribute> attributes = {
      {"kernel_shape", {3, 3}}, {"strides", {1, 1}}, {"pads", {1, 1, 1, 1}}, {"group", 1}};
  std::string op = "Conv", after;
  bool writes_output = true;

  std::string Onnx() const {
    const auto size = [](const OnnxShape& shape) {
      std::size_t n = 1;
      for (const std::int64_t length : shape) n *= static_cast<std::size_t>(length);
      return n;
    };
    OnnxWriter writer;
    const auto in = writer.Input("images", input);
    const auto w =
        writer.Parameter("conv.weight", weight, std::vector<float>(size(weight), 0.125f));
    const auto b = writer.Parameter("conv.bias", bias, std::vector<float>(size(bias), 1.f));
    auto x = writer.Apply(op.c_str(), {in, w, b}, attributes);
    if (!after.empty()) x = writer.Apply(after.c_str(), {x});
    if (writes_output) writer.Output(x, "out", {1, 4, 32, 64});
    return writer.Model("one_conv");
  }
};

TEST(NetworkFile, ReadsWhatWasWritten) {
  for (const std::string& name : kYoloxNetworks) {
    const LayerTable table = MakeYolox(name).table;
    const NetworkWeights weights = RandomWeights(table, 2);
    const NetworkModel read = ParseNetwork(NetworkOnnx(table, weights, 64, 96), name);
    EXPECT_EQ(read.height, 64);
    EXPECT_EQ(read.width, 96);
    EXPECT_EQ(read.table.outputs, table.outputs);
    ASSERT_EQ(read.table.layers.size(), table.layers.size());
    for (std::size_t i = 0; i < table.layers.size(); ++i) {
      const Layer &a = read.table.layers[i], &b = table.layers[i];
      EXPECT_EQ(a.kind, b.kind) << b.name;
      EXPECT_EQ(a.inputs, b.inputs) << b.name;
      EXPECT_EQ(a.channels, b.channels) << b.name;
      EXPECT_EQ(a.activation, b.activation) << b.name;
      EXPECT_EQ(a.kernel, b.kernel) << b.name;
      EXPECT_EQ(a.stride, b.stride) << b.name;
      EXPECT_EQ(a.groups, b.groups) << b.name;
      EXPECT_EQ(read.weights.layers[i].weight, weights.layers[i].weight) << b.name;
      EXPECT_EQ(read.weights.layers[i].bias, weights.layers[i].bias) << b.name;
    }
  }
}

TEST(NetworkFile, SaysWhatIsWrong) {
  EXPECT_EQ(MessageOf(OneConv{}.Onnx()), "no error");
  const auto with = [](const std::function<void(OneConv*)>& spoil) {
    OneConv one;
    spoil(&one);
    return MessageOf(one.Onnx());
  };
  EXPECT_THAT(with([](OneConv* one) { one->op = "Gemm"; }),
              AllOf(HasSubstr("net.onnx: node t0 (Gemm): must be of Add, Concat, Conv, "),
                    HasSubstr("(found Gemm)")));
  EXPECT_THAT(with([](OneConv* one) { one->after = "Exp"; }), HasSubstr("(Exp): must be of"));
  EXPECT_THAT(with([](OneConv* one) {
                one->input = {1, 3, 33, 64};
              }),
              HasSubstr("input images: must be float32 of 1 x 3 x height x width, multiples of 32 "
                        "up to 2048 (found [1, 3, 33, 64])"));
  EXPECT_THAT(with([](OneConv* one) { one->input = {1, 3, 4096, 64}; }), HasSubstr("up to 2048"));
  EXPECT_THAT(with([](OneConv* one) { one->input = {1, 1, 32, 64}; }), HasSubstr("1 x 3 x"));
  EXPECT_THAT(with([](OneConv* one) {
                one->weight = {4, 2, 3, 3};
              }),
              HasSubstr("must be of groups that fit 3 channels (found [1] of 2)"));
  EXPECT_THAT(with([](OneConv* one) { one->weight = {4, 3, 3, 1}; }), HasSubstr("square kernel"));
  EXPECT_THAT(with([](OneConv* one) { one->bias = {3}; }), HasSubstr("a bias for each channel"));
  EXPECT_THAT(with([](OneConv* one) {
                one->attributes[2] = {"pads", {0, 0, 1, 1}};
              }),
              HasSubstr("must be of pads [1, 1, 1, 1] (found [0, 0, 1, 1])"));
  EXPECT_THAT(with([](OneConv* one) {
                one->attributes[1] = {"strides", {0, 0}};
              }),
              HasSubstr("one stride up to 32"));
  EXPECT_THAT(with([](OneConv* one) {
                one->attributes.push_back({"dilations", {2, 2}});
              }),
              HasSubstr("must be of dilations [1, 1]"));
  EXPECT_THAT(with([](OneConv* one) {
                one->attributes.push_back({"padding", 1});
              }),
              HasSubstr("must be without attributes but"));
  EXPECT_THAT(with([](OneConv* one) { one->writes_output = false; }),
              HasSubstr("outputs: must be"));
  EXPECT_EQ(MessageOf(""), "net.onnx: must be an ONNX model, whole and readable");
  EXPECT_EQ(MessageOf("<html>"), "net.onnx: must be an ONNX model, whole and readable");
}

TEST(NetworkFile, RefusesWeightsThatAreNotFinite) {
  std::string onnx = OneConv{}.Onnx();
  const float weight = 0.125f, nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t at = onnx.find(std::string(reinterpret_cast<const char*>(&weight), 4));
  ASSERT_NE(at, std::string::npos);
  onnx.replace(at, 4, reinterpret_cast<const char*>(&nan), 4);
  EXPECT_THAT(MessageOf(onnx), AllOf(HasSubstr("net.onnx: layer out"), HasSubstr("finite")));
}

TEST(NetworkFile, RefusesFilesThatAreTooLargeOrMissing) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "large.onnx";
  std::ofstream(file, std::ios::binary) << "x";
  std::filesystem::resize_file(file, std::uintmax_t{1} << 30);
  EXPECT_THAT(MessageOf([&] { ReadNetwork(file); }),
              HasSubstr("large.onnx: must be at most 16777216 bytes (found 1073741824)"));
  EXPECT_THAT(MessageOf([&] { ReadNetwork(folder.path() / "none.onnx"); }),
              HasSubstr("none.onnx: must be a file that can be read"));
}

// Whatever a file holds: it is refused, or it is a network that runs.
TEST(NetworkFile, NothingInAFileBringsItDown) {
  const YoloxNetwork network = MakeYolox("yolox_small");
  const std::string whole = NetworkOnnx(network.table, RandomWeights(network.table, 2), 32, 32);
  RandomStream stream(1, "mutations");
  const auto below = [&](std::size_t n) {
    return static_cast<std::size_t>(stream.Uniform() * static_cast<double>(n));
  };
  int refused = 0, run = 0;
  const int kFiles = 300;
  for (int i = 0; i < kFiles; ++i) {
    std::string onnx = whole;
    // Most of a file is weights: half of the mutations hit its first bytes, which are nodes.
    const std::size_t range = i % 2 == 0 ? 20000 : onnx.size();
    for (std::size_t k = 0; k <= below(4); ++k) onnx[below(range)] = static_cast<char>(below(256));
    if (i % 10 == 0) onnx.resize(below(onnx.size()));
    try {
      const NetworkModel model = ParseNetwork(onnx, "mutant");
      ++run;
      if (run % 10 != 0) continue;  // Engines take long to make.
      const InferenceTask task{model.table, model.weights,
                               ShapesOf(model.table, model.height, model.width), 1};
      const auto engine = Inference().make_onednn(task);
      engine->Run(
          std::vector<float>(static_cast<std::size_t>(3 * model.height * model.width), 0.5f));
    } catch (const ConfigError& error) {
      EXPECT_THAT(error.what(), HasSubstr("mutant: "));
      ++refused;
    }
  }
  EXPECT_GT(refused, kFiles / 5);
  EXPECT_GT(run, kFiles / 5);
}

DetectorCard Card(const TemporaryFolder& folder) {
  const YoloxNetwork network = MakeYolox("yolox_small");
  const auto file =
      folder.Write("w.onnx", NetworkOnnx(network.table, RandomWeights(network.table, 2), 64, 96));
  DetectorCard card;
  card.network = "yolox_small";
  card.detector = {"w.onnx", Sha256OfFile(file)};
  card.min_score = 0.25;
  card.refiner = card.detector;
  card.refiner_margin = 1.75;
  card.box_noise = {{"sigma_px", 0.5}};
  card.provenance = {{"seed", 3}};
  return card;
}

TEST(DetectorCard, ReadsWhatWasWritten) {
  const TemporaryFolder folder;
  const DetectorCard card = Card(folder);
  const DetectorCard read = ReadDetectorCard(folder.Write("c.json", DetectorCardText(card)));
  EXPECT_EQ(DetectorCardText(read), DetectorCardText(card));
  EXPECT_EQ(read.refiner_margin, 1.75);
  EXPECT_EQ(ReadWeights(read.detector, folder.path()).width, 96);
}

TEST(DetectorCard, SaysWhatIsWrong) {
  const TemporaryFolder folder;
  const DetectorCard card = Card(folder);
  const auto with = [&](const std::function<void(DetectorCard*)>& spoil) {
    DetectorCard spoilt = card;
    spoil(&spoilt);
    return MessageOf([&] { ParseDetectorCard(DetectorCardText(spoilt), "c.json"); });
  };
  EXPECT_EQ(with([](DetectorCard* c) { c->min_score = 2; }),
            "c.json: detector.min_score: must be a number from 0.001 to 0.999 (found '2.0')");
  EXPECT_THAT(with([](DetectorCard* c) { c->detector.onnx = "../w.onnx"; }),
              HasSubstr("detector.onnx: must be the name of a file beside the card"));
  EXPECT_THAT(with([](DetectorCard* c) { c->refiner->sha256 = "1"; }),
              HasSubstr("refiner.sha256: must be 64 digits"));
  EXPECT_THAT(MessageOf([] { ParseDetectorCard("{", "c.json"); }),
              HasSubstr("c.json:1:2: must be"));
  EXPECT_THAT(MessageOf([&] {
                ReadWeights({"w.onnx", std::string(64, '0')}, folder.path());
              }),
              HasSubstr("w.onnx: must be the file of the card, of sha256 0000"));
  const auto file = folder.Write("one.onnx", OneConv{}.Onnx());
  EXPECT_THAT(
      MessageOf([&] {
        ReadWeights({"one.onnx", Sha256OfFile(file)}, folder.path());
      }),
      HasSubstr("output out: must be 6 numbers for each cell of a grid (found 4 x 32 x 64)"));
}

}  // namespace
}  // namespace windhover
