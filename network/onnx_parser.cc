#include "network/onnx_parser.h"

#include <cstring>
#include <stdexcept>

#define ONNX_ML 1
#define ONNX_NAMESPACE onnx
#include <onnx/onnx_pb.h>

namespace windhover {
namespace {

OnnxGraph::Attribute Attribute(const onnx::AttributeProto& proto) {
  OnnxGraph::Attribute attribute;
  if (proto.type() == onnx::AttributeProto::INT) {
    attribute.ints = {proto.i()};
  } else if (proto.type() == onnx::AttributeProto::INTS) {
    attribute.ints.assign(proto.ints().begin(), proto.ints().end());
  } else if (proto.type() == onnx::AttributeProto::STRING) {
    attribute.text = proto.s();
  } else {
    attribute.other = true;
  }
  return attribute;
}

OnnxGraph::Node Node(const onnx::NodeProto& proto) {
  OnnxGraph::Node node;
  node.op = proto.domain().empty() ? proto.op_type() : proto.domain() + "." + proto.op_type();
  node.name = proto.name();
  node.inputs.assign(proto.input().begin(), proto.input().end());
  node.outputs.assign(proto.output().begin(), proto.output().end());
  for (const onnx::AttributeProto& attribute : proto.attribute()) {
    node.attributes[attribute.name()] = Attribute(attribute);
  }
  return node;
}

OnnxGraph::Tensor Tensor(const onnx::TensorProto& proto) {
  OnnxGraph::Tensor tensor;
  tensor.name = proto.name();
  tensor.lengths.assign(proto.dims().begin(), proto.dims().end());
  tensor.is_float = proto.data_type() == onnx::TensorProto::FLOAT &&
                    proto.external_data().empty() &&
                    proto.data_location() != onnx::TensorProto::EXTERNAL;
  if (!tensor.is_float) return tensor;
  if (!proto.has_raw_data()) {
    tensor.values.assign(proto.float_data().begin(), proto.float_data().end());
    return tensor;
  }
  const std::string& raw = proto.raw_data();
  tensor.values.resize(raw.size() / sizeof(float));
  std::memcpy(tensor.values.data(), raw.data(), tensor.values.size() * sizeof(float));
  return tensor;
}

OnnxGraph::Value Value(const onnx::ValueInfoProto& proto) {
  OnnxGraph::Value value;
  value.name = proto.name();
  if (proto.type().tensor_type().elem_type() != onnx::TensorProto::FLOAT) return value;
  for (const auto& dimension : proto.type().tensor_type().shape().dim()) {
    value.lengths.push_back(dimension.has_dim_value() ? dimension.dim_value() : -1);
  }
  return value;
}

}  // namespace

OnnxGraph ParseOnnx(std::string_view file) {
  onnx::ModelProto model;
  if (!model.ParseFromArray(file.data(), static_cast<int>(file.size())) || !model.has_graph()) {
    throw std::runtime_error("must be an ONNX model, whole and readable");
  }
  OnnxGraph graph;
  if (model.opset_import_size() == 1 && model.opset_import(0).domain().empty()) {
    graph.opset = model.opset_import(0).version();
  }
  const onnx::GraphProto& proto = model.graph();
  for (const auto& node : proto.node()) graph.nodes.push_back(Node(node));
  for (const auto& tensor : proto.initializer()) graph.initializers.push_back(Tensor(tensor));
  for (const auto& value : proto.input()) graph.inputs.push_back(Value(value));
  for (const auto& value : proto.output()) graph.outputs.push_back(value.name());
  return graph;
}

}  // namespace windhover
