#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace windhover {

/// Lengths along the axes of a tensor, slowest first.
using OnnxShape = std::vector<std::int64_t>;

/// Writes a network as an ONNX model (opset 11, IR 6) for other programs to run: its operators,
/// in the order in which they are added, are the nodes of the graph. All tensors are float32, and
/// what is written depends on nothing but what is added.
/// Sources: onnx.proto and Operators.md of ONNX 1.6; the protobuf wire format.
class OnnxWriter {
 public:
  static constexpr int kOpset = 11, kIrVersion = 6;

  /// What an operator takes and gives: the name of a tensor.
  using Tensor = std::string;
  /// A list of whole numbers, such as {"perm", {0, 2, 1}}, or one: {"keepdims", 1}; or a word.
  struct Attribute {
    enum class Kind { kNumber, kNumbers, kWord };
    Attribute(const char* attribute, std::int64_t value)
        : name(attribute), kind(Kind::kNumber), values{value} {}
    Attribute(const char* attribute, std::initializer_list<std::int64_t> list)
        : name(attribute), kind(Kind::kNumbers), values(list) {}
    Attribute(const char* attribute, std::string_view value)
        : name(attribute), kind(Kind::kWord), word(value) {}
    std::string name;
    Kind kind;
    std::vector<std::int64_t> values;
    std::string word;
  };

  Tensor Input(const std::string& name, const OnnxShape& shape);

  /// An initializer: what was learned.
  /// @throws std::invalid_argument unless `values` fill `shape` and are finite.
  Tensor Parameter(const std::string& name, const OnnxShape& shape, std::span<const float> values);

  /// A number that belongs to the method: a tensor full of it, by a node of its own.
  Tensor Constant(float value, const OnnxShape& shape = {1});

  /// The result of an operator of ONNX's standard set. An input that is left out is "".
  Tensor Apply(const char* op, const std::vector<Tensor>& inputs,
               const std::vector<Attribute>& attributes = {});

  /// The same elements in another shape.
  Tensor Reshape(const Tensor& tensor, const OnnxShape& shape);

  /// Gives `tensor` out as `name`.
  void Output(const Tensor& tensor, const std::string& name, const OnnxShape& shape);

  /// The content of an .onnx file. @param name that of the graph.
  std::string Model(const std::string& name) const;

 private:
  Tensor ConstantOf(const std::string& tensor_message);
  Tensor AddNode(const char* op, const std::vector<Tensor>& inputs, const std::string& attributes,
                 const std::string& output);
  std::string NextName() { return "t" + std::to_string(n_tensors_++); }

  // Fields of GraphProto, encoded.
  std::string nodes_, initializers_, inputs_, outputs_;
  int n_tensors_ = 0;
};

}  // namespace windhover
