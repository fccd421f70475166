#pragma once

#include <string>

#include "network/network_file.h"
#include "network/onnx_graph.h"

namespace windhover {

/// The table of layers that a graph is, with its weights; no onnx_file.
/// @param name of the file, for messages.
/// @throws ConfigError of what is beyond ReadNetwork()'s limits.
NetworkModel ReadGraph(const OnnxGraph& graph, const std::string& name);

}  // namespace windhover
