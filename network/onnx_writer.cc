#include "network/onnx_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace windhover {
namespace {

static_assert(std::endian::native == std::endian::little, "raw_data is little-endian");

// TensorProto.DataType and AttributeProto.AttributeType.
constexpr int kFloat = 1, kInt64 = 7;
constexpr int kAttributeInt = 2, kAttributeString = 3, kAttributeTensor = 4, kAttributeInts = 7;

// --- Protobuf: each of these is one field of a message. -----------------------------------------

std::string Varint(std::uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(0x80 | (value & 0x7f));
  return bytes + static_cast<char>(value);
}

std::string Number(unsigned field, std::int64_t value) {
  return Varint(field << 3) + Varint(static_cast<std::uint64_t>(value));
}

std::string Text(unsigned field, const std::string& content) {
  return Varint(field << 3 | 2) + Varint(content.size()) + content;
}

std::string Numbers(unsigned field, std::span<const std::int64_t> values) {
  std::string bytes;
  for (const std::int64_t value : values) bytes += Number(field, value);
  return bytes;
}

// --- Messages of onnx.proto. ---------------------------------------------------------------------

template <typename T>
std::string TensorProto(int type, const OnnxShape& shape, std::span<const T> values,
                        const std::string& name) {
  std::string bytes = Numbers(1, shape) + Number(2, type);
  if (!name.empty()) bytes += Text(8, name);
  return bytes + Text(9, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

std::size_t SizeOf(const OnnxShape& shape) {
  return static_cast<std::size_t>(
      std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>()));
}

std::string ValueInfoProto(const std::string& name, const OnnxShape& shape) {
  std::string dimensions;
  for (const std::int64_t length : shape) dimensions += Text(1, Number(1, length));
  return Text(1, name) + Text(2, Text(1, Number(1, kFloat) + Text(2, dimensions)));
}

std::string AttributeProto(const OnnxWriter::Attribute& attribute) {
  using Kind = OnnxWriter::Attribute::Kind;
  if (attribute.kind == Kind::kNumbers) {
    return Text(1, attribute.name) + Numbers(8, attribute.values) + Number(20, kAttributeInts);
  }
  if (attribute.kind == Kind::kWord) {
    return Text(1, attribute.name) + Text(4, attribute.word) + Number(20, kAttributeString);
  }
  return Text(1, attribute.name) + Number(3, attribute.values.front()) + Number(20, kAttributeInt);
}

}  // namespace

OnnxWriter::Tensor OnnxWriter::Input(const std::string& name, const OnnxShape& shape) {
  inputs_ += Text(11, ValueInfoProto(name, shape));
  return name;
}

OnnxWriter::Tensor OnnxWriter::Parameter(const std::string& name, const OnnxShape& shape,
                                         std::span<const float> values) {
  if (values.size() != SizeOf(shape) ||
      !std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); })) {
    throw std::invalid_argument(name + ": must fill its shape with finite numbers");
  }
  initializers_ += Text(5, TensorProto(kFloat, shape, values, name));
  return name;
}

OnnxWriter::Tensor OnnxWriter::ConstantOf(const std::string& tensor_message) {
  const std::string attribute =
      Text(1, "value") + Text(5, tensor_message) + Number(20, kAttributeTensor);
  return AddNode("Constant", {}, Text(5, attribute), NextName());
}

OnnxWriter::Tensor OnnxWriter::Constant(float value, const OnnxShape& shape) {
  const std::vector<float> values(SizeOf(shape), value);
  return ConstantOf(TensorProto<float>(kFloat, shape, values, ""));
}

OnnxWriter::Tensor OnnxWriter::Apply(const char* op, const std::vector<Tensor>& inputs,
                                     const std::vector<Attribute>& attributes) {
  std::string fields;
  for (const Attribute& attribute : attributes) fields += Text(5, AttributeProto(attribute));
  return AddNode(op, inputs, fields, NextName());
}

OnnxWriter::Tensor OnnxWriter::Reshape(const Tensor& tensor, const OnnxShape& shape) {
  const OnnxShape axes = {static_cast<std::int64_t>(shape.size())};
  return Apply("Reshape", {tensor, ConstantOf(TensorProto<std::int64_t>(kInt64, axes, shape, ""))});
}

void OnnxWriter::Output(const Tensor& tensor, const std::string& name, const OnnxShape& shape) {
  AddNode("Identity", {tensor}, "", name);
  outputs_ += Text(12, ValueInfoProto(name, shape));
}

OnnxWriter::Tensor OnnxWriter::AddNode(const char* op, const std::vector<Tensor>& inputs,
                                       const std::string& attributes, const std::string& output) {
  std::string node;
  for (const Tensor& input : inputs) node += Text(1, input);
  node += Text(2, output) + Text(3, output) + Text(4, op) + attributes;
  nodes_ += Text(1, node);
  return output;
}

std::string OnnxWriter::Model(const std::string& name) const {
  const std::string graph = nodes_ + Text(2, name) + initializers_ + inputs_ + outputs_;
  return Number(1, kIrVersion) + Text(2, "windhover") + Text(7, graph) +
         Text(8, Text(1, "") + Number(2, kOpset));
}

}  // namespace windhover
