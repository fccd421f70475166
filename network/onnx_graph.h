#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace windhover {

/// What windhover looks at in an .onnx file, as it stands there: nothing is checked yet.
/// Source: onnx.proto of ONNX 1.12.
struct OnnxGraph {
  struct Attribute {
    std::vector<std::int64_t> ints;  ///< Of an INTS, or the one of an INT.
    std::string text;                ///< Of a STRING.
    bool other = false;              ///< It is of any other kind.
  };
  struct Node {
    std::string op, name;
    std::vector<std::string> inputs, outputs;
    std::map<std::string, Attribute> attributes;
  };
  struct Tensor {
    std::string name;
    std::vector<std::int64_t> lengths;
    bool is_float = false;      ///< float32, inside the file.
    std::vector<float> values;  ///< As many as are there.
  };
  /// An input; a length that is no number is -1.
  struct Value {
    std::string name;
    std::vector<std::int64_t> lengths;
  };

  std::int64_t opset = 0;  ///< Of the standard operators; 0 if others are used, too.
  std::vector<Node> nodes;
  std::vector<Tensor> initializers;
  std::vector<Value> inputs;
  std::vector<std::string> outputs;
};

}  // namespace windhover
