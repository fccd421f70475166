#include "learn/pcm_onnx.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/dnn.hpp>

#include "common/random/random_stream.h"
#include "network/onnx_writer.h"

namespace windhover {
namespace {

using ::testing::ElementsAre;
using ::testing::IsSubsetOf;

/// A field of a protobuf message: a number, or bytes.
struct Field {
  std::uint64_t field, number;
  std::string bytes;
};

std::uint64_t Varint(const std::string& message, std::size_t* at) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const auto byte = static_cast<unsigned char>(message.at((*at)++));
    value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  throw std::runtime_error("a varint that does not end");
}

std::vector<Field> Fields(const std::string& message) {
  std::vector<Field> fields;
  for (std::size_t at = 0; at < message.size();) {
    const std::uint64_t key = Varint(message, &at);
    Field field{key >> 3, Varint(message, &at), ""};
    if ((key & 7) == 2) {
      if (field.number > message.size() - at) throw std::runtime_error("cut short");
      field.bytes = message.substr(at, field.number);
      at += field.number;
    } else if ((key & 7) != 0) {
      throw std::runtime_error("neither a varint nor bytes");
    }
    fields.push_back(field);
  }
  return fields;
}

std::vector<Field> All(const std::string& message, std::uint64_t wanted) {
  std::vector<Field> fields = Fields(message);
  std::erase_if(fields, [&](const Field& field) { return field.field != wanted; });
  return fields;
}

Field One(const std::string& message, std::uint64_t wanted) {
  const std::vector<Field> fields = All(message, wanted);
  if (fields.size() != 1) throw std::runtime_error("must be there once");
  return fields.front();
}

/// What onnx.proto says of a ModelProto.
struct Model {
  explicit Model(const std::string& bytes) {
    ir_version = One(bytes, 1).number;
    opset = One(One(bytes, 8).bytes, 2).number;
    const std::string graph = One(bytes, 7).bytes;
    for (const Field& tensor : All(graph, 5)) AddInitializer(tensor.bytes);
    for (const Field& value : All(graph, 11)) AddValue(value.bytes);
    for (const Field& node : All(graph, 1)) AddNode(node.bytes);
    for (const Field& value : All(graph, 12)) AddValue(value.bytes);
  }

  std::uint64_t ir_version, opset;
  std::map<std::string, std::vector<std::uint64_t>> shapes;  ///< Of inputs and outputs.
  std::vector<float> initializers;
  std::set<std::string> ops, defined, undefined;

 private:
  void AddInitializer(const std::string& tensor) {
    EXPECT_EQ(One(tensor, 2).number, 1u) << "float";
    std::size_t size = 1;
    for (const Field& length : All(tensor, 1)) size *= length.number;
    const std::string raw = One(tensor, 9).bytes;
    ASSERT_EQ(raw.size(), size * sizeof(float));
    std::vector<float> values(size);
    std::memcpy(values.data(), raw.data(), raw.size());
    initializers.insert(initializers.end(), values.begin(), values.end());
    EXPECT_TRUE(defined.insert(One(tensor, 8).bytes).second) << "a name used twice";
  }
  void AddValue(const std::string& value) {
    const std::string tensor = One(One(value, 2).bytes, 1).bytes;
    EXPECT_EQ(One(tensor, 1).number, 1u) << "float";
    const std::string name = One(value, 1).bytes;
    for (const Field& length : All(One(tensor, 2).bytes, 1)) {
      shapes[name].push_back(One(length.bytes, 1).number);
    }
    defined.insert(name);
  }
  void AddNode(const std::string& node) {
    ops.insert(One(node, 4).bytes);
    for (const Field& input : All(node, 1)) {
      if (!defined.contains(input.bytes)) undefined.insert(input.bytes);
    }
    EXPECT_TRUE(defined.insert(One(node, 2).bytes).second) << "a name used twice";
  }
};

std::vector<float> Sorted(std::vector<float> values) {
  std::sort(values.begin(), values.end());
  return values;
}

Mixer RandomMixer(int width, int n_outputs, RandomStream* random) {
  std::vector<float> parameters;
  for (int i = MixerParameters(width, n_outputs); i > 0; --i) {
    parameters.push_back(static_cast<float>(random->Normal() / std::sqrt(width)));
  }
  return {width, n_outputs, parameters};
}

TEST(OnnxWriter, WritesTheBytesOfOnnxProto) {
  OnnxWriter writer;
  writer.Output(writer.Input("x", {2}), "y", {2});
  const std::string node = "\x0a\x01x\x12\x01y\x1a\x01y\x22\x08Identity";
  // Name; type { tensor_type { elem_type: FLOAT, shape { dim { dim_value: 2 } } } }.
  const auto value = [](const std::string& name) {
    return "\x0a\x01" + name + "\x12\x0a\x0a\x08\x08\x01\x12\x04\x0a\x02\x08\x02";
  };
  const std::string graph =
      "\x0a\x13" + node + "\x12\x01g" + "\x5a\x0f" + value("x") + "\x62\x0f" + value("y");
  EXPECT_EQ(writer.Model("g"), std::string("\x08\x06\x12\x09windhover\x3a\x3a") + graph +
                                   std::string("\x42\x04\x0a\x00\x10\x0b", 6));
}

TEST(OnnxWriter, RefusesParametersThatAreNone) {
  OnnxWriter writer;
  const std::vector<float> two = {1, 2}, bad = {1, std::numeric_limits<float>::quiet_NaN()};
  EXPECT_THROW(writer.Parameter("p", {3}, two), std::invalid_argument);
  EXPECT_THROW(writer.Parameter("p", {2}, bad), std::invalid_argument);
}

TEST(PcmOnnx, HasTheShapesAndParametersOfTheMixer) {
  RandomStream random(1, "onnx");
  for (const int width : kMixerWidths) {
    for (const int n_outputs : {1, 2}) {
      const Mixer mixer = RandomMixer(width, n_outputs, &random);
      const Model model(MixerOnnx(mixer));
      EXPECT_EQ(model.ir_version, 6u);
      EXPECT_EQ(model.opset, 11u);
      EXPECT_EQ(model.shapes.size(), 2u);
      EXPECT_THAT(model.shapes.at("tokens"), ElementsAre(2, 4));
      EXPECT_THAT(model.shapes.at(n_outputs == 1 ? "offsets" : "logits"),
                  ElementsAre(2, n_outputs));
      EXPECT_EQ(Sorted(model.initializers), Sorted(mixer.parameters()));
      EXPECT_THAT(model.undefined, ::testing::IsEmpty());
      EXPECT_THAT(model.ops,
                  IsSubsetOf({"Add", "Constant", "Div", "Erf", "Identity", "MatMul", "Mul",
                              "ReduceMean", "Reshape", "Sqrt", "Sub", "Tanh", "Transpose"}));
    }
  }
  EXPECT_EQ(Model(MixerOnnx(RandomMixer(4, 1, &random))).initializers.size(), 393u);
  EXPECT_EQ(Model(MixerOnnx(RandomMixer(4, 2, &random))).initializers.size(), 398u);
}

TEST(PcmOnnx, OpenCvComputesWhatTheMixerDoes) {
  RandomStream random(2, "onnx");
  for (const int width : kMixerWidths) {
    for (const int n_outputs : {1, 2}) {
      const Mixer mixer = RandomMixer(width, n_outputs, &random);
      const std::string model = MixerOnnx(mixer);
      cv::dnn::Net net = cv::dnn::readNetFromONNX(model.data(), model.size());
      double least = 1e9, most = -1e9;
      for (int i = 0; i < 50; ++i) {
        BoxTokens sides[2];
        for (BoxTokens& tokens : sides) {
          for (float& token : tokens) token = static_cast<float>(random.Uniform(-2, 2));
        }
        net.setInput(cv::Mat(2, 4, CV_32F, sides), "tokens");
        const cv::Mat out = net.forward();
        ASSERT_EQ(out.total(), 2u * static_cast<unsigned>(n_outputs));
        const auto expected = mixer.Evaluate(sides[0], sides[1]);
        for (int k = 0; k < 2 * n_outputs; ++k) {
          const float value = expected[k / n_outputs][k % n_outputs];
          // Sums of 100 floats near 1 in another order, and two approximations of Φ.
          EXPECT_NEAR(out.ptr<float>()[k], value, 1e-5) << width << " " << n_outputs;
          least = std::min<double>(least, value);
          most = std::max<double>(most, value);
        }
      }
      EXPECT_GT(most - least, 1e-3) << "a hundred tolerances";
    }
  }
}

TEST(PcmOnnx, NamesNetworksAsTheCardDoes) {
  RandomStream random(3, "onnx");
  PcmStages stages;
  for (int i = 0; i < 2; ++i) stages.offsets.push_back(RandomMixer(4, 1, &random));
  stages.gates.push_back(RandomMixer(4, 2, &random));
  stages.alone = RandomMixer(4, 1, &random);
  std::vector<std::string> names;
  for (const NamedModel& network : PcmOnnx(stages)) names.push_back(network.name);
  EXPECT_THAT(names, ElementsAre("offset0", "gate0", "offset1", "alone"));
  EXPECT_EQ(PcmOnnx(stages)[1].model, MixerOnnx(stages.gates[0]));
  EXPECT_EQ(PcmOnnx(stages)[2].model, MixerOnnx(stages.offsets[1]));
}

}  // namespace
}  // namespace windhover
