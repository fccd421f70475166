#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "network/layer_table.h"
#include "network/onnx_graph.h"

namespace windhover {

/// A node of an .onnx file and what may be asked of it. All throw ConfigError with file and node.
class OnnxNode {
 public:
  using Lengths = std::vector<std::int64_t>;

  /// Both must outlive it.
  OnnxNode(const OnnxGraph::Node& node, const std::string& file) : node_(node), file_(file) {}

  const std::string& op() const { return node_.op; }
  const std::vector<std::string>& inputs() const { return node_.inputs; }
  const std::vector<std::string>& outputs() const { return node_.outputs; }

  /// "FILE: node OUTPUT (OP): must be `must` (found `found`)".
  [[noreturn]] void Refuse(const std::string& must, const std::string& found) const;

  /// No attributes but these.
  void AllowOnly(std::initializer_list<const char*> allowed) const;

  /// An attribute; what ONNX takes it for where it is not there.
  Lengths Ints(const std::string& key, Lengths otherwise) const;
  void MustEqual(const std::string& key, const Lengths& expected, const Lengths& otherwise) const;
  void MustSay(const std::string& key, const std::string& expected,
               const std::string& otherwise) const;

  /// Kernel, stride and padding of a window, which must be alike in both directions.
  void ReadWindow(const Lengths& kernel, Layer* layer) const;

 private:
  const OnnxGraph::Node& node_;
  const std::string& file_;
};

}  // namespace windhover
