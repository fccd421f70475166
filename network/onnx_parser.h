#pragma once

#include <string_view>

#include "network/onnx_graph.h"

namespace windhover {

/// Part of windhover_inference.so: InferenceLibrary::parse_onnx.
OnnxGraph ParseOnnx(std::string_view file);

}  // namespace windhover
