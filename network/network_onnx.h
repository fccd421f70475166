#pragma once

#include <string>

#include "network/layer_table.h"

namespace windhover {

/// The network as the content of an .onnx file for one image of that size: input "images" (1 ×
/// channels × height × width), an output by its layer's name for each of the table's. The
/// initializers of a convolution are NAME.weight and NAME.bias, in the order of the table.
/// Operators: Conv, Sigmoid, Mul, Relu, MaxPool, Resize, Concat, Add, Identity.
/// @throws std::invalid_argument if the weights do not fit the table or are not finite.
std::string NetworkOnnx(const LayerTable& table, const NetworkWeights& weights, int height,
                        int width);

}  // namespace windhover
