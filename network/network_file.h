#pragma once

#include <filesystem>
#include <string>

#include "network/layer_table.h"

namespace windhover {

/// A network with its weights, and for which images it was written.
struct NetworkModel {
  LayerTable table;
  NetworkWeights weights;
  int height = 0, width = 0;  ///< px
  std::string onnx_file;      ///< What it was read from.
};

/// Reads the content of an .onnx file with the operators of network/network_onnx.h.
///
/// Its limits: 16 MiB; operators Conv, Relu, Sigmoid and Mul (as x · sigmoid(x)), MaxPool, Resize
/// (nearest, by 2), Concat of channels, Add, Identity, of the opsets 11 to 17; up to 2,000 nodes;
/// one input 1 × 3 × height × width, both multiples of 32 up to 2,048; up to 4,096 channels;
/// weights finite; results of up to 64 Mi numbers and 50 G multiplications in all.
/// @throws ConfigError `NAME: node …: must be … (found …)`.
NetworkModel ParseNetwork(std::string file, const std::string& name);

/// The same for a file. @throws ConfigError also if it is missing, larger than 16 MiB or cannot be
/// read.
NetworkModel ReadNetwork(const std::filesystem::path& file);

}  // namespace windhover
