#include "network/onnx_node.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/config/fields.h"

namespace windhover {
namespace {

constexpr int kMaxKernel = 31;

}  // namespace

void OnnxNode::Refuse(const std::string& must, const std::string& found) const {
  const std::string& output = outputs().empty() ? node_.name : outputs().front();
  throw ConfigError(
      fmt::format("{}: node {} ({}): must be {} (found {})", file_, output, op(), must, found));
}

void OnnxNode::AllowOnly(std::initializer_list<const char*> allowed) const {
  for (const auto& [key, attribute] : node_.attributes) {
    const bool known = std::any_of(allowed.begin(), allowed.end(),
                                   [&, &k = key](const char* one) { return k == one; });
    if (!known || attribute.other) {
      Refuse(fmt::format("without attributes but {}", fmt::join(allowed, ", ")), key);
    }
  }
}

OnnxNode::Lengths OnnxNode::Ints(const std::string& key, Lengths otherwise) const {
  const auto attribute = node_.attributes.find(key);
  return attribute == node_.attributes.end() ? std::move(otherwise) : attribute->second.ints;
}

void OnnxNode::MustEqual(const std::string& key, const Lengths& expected,
                         const Lengths& otherwise) const {
  const Lengths found = Ints(key, otherwise);
  if (found == expected) return;
  Refuse(fmt::format("of {} [{}]", key, fmt::join(expected, ", ")),
         fmt::format("[{}]", fmt::join(found, ", ")));
}

void OnnxNode::MustSay(const std::string& key, const std::string& expected,
                       const std::string& otherwise) const {
  const auto attribute = node_.attributes.find(key);
  const std::string found =
      attribute == node_.attributes.end() ? otherwise : attribute->second.text;
  if (found != expected) Refuse(fmt::format("of {} {}", key, expected), found);
}

void OnnxNode::ReadWindow(const Lengths& kernel, Layer* layer) const {
  const Lengths strides = Ints("strides", {1, 1});
  if (kernel.size() != 2 || kernel[0] != kernel[1] || kernel[0] < 1 || kernel[0] > kMaxKernel) {
    Refuse(fmt::format("of a square kernel up to {}", kMaxKernel),
           fmt::format("[{}]", fmt::join(kernel, ", ")));
  }
  if (strides.size() != 2 || strides[0] != strides[1] || strides[0] < 1 || strides[0] > 32) {
    Refuse("of one stride up to 32", fmt::format("[{}]", fmt::join(strides, ", ")));
  }
  layer->kernel = static_cast<int>(kernel[0]);
  layer->stride = static_cast<int>(strides[0]);
  const std::int64_t padding = (kernel[0] - 1) / 2;
  MustEqual("kernel_shape", kernel, kernel);
  MustEqual("pads", {padding, padding, padding, padding}, {0, 0, 0, 0});
  MustEqual("dilations", {1, 1}, {1, 1});
  MustSay("auto_pad", "NOTSET", "NOTSET");
}

}  // namespace windhover
