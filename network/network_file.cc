#include "network/network_file.h"

#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "common/config/fields.h"
#include "network/graph_reader.h"
#include "network/inference.h"

namespace windhover {
namespace {

constexpr std::uintmax_t kMaxBytes = 16 << 20;

}  // namespace

NetworkModel ParseNetwork(std::string file, const std::string& name) {
  if (file.size() > kMaxBytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", name, kMaxBytes, file.size()));
  }
  OnnxGraph graph;
  try {
    graph = Inference().parse_onnx(file);
  } catch (const std::runtime_error& error) {
    throw ConfigError(fmt::format("{}: {}", name, error.what()));
  }
  NetworkModel model = ReadGraph(graph, name);
  model.onnx_file = std::move(file);
  return model;
}

NetworkModel ReadNetwork(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(file, error);
  std::ifstream in(file, std::ios::binary);
  if (error || !in) {
    throw ConfigError(fmt::format("{}: must be a file that can be read", file.string()));
  }
  if (bytes > kMaxBytes) {
    throw ConfigError(
        fmt::format("{}: must be at most {} bytes (found {})", file.string(), kMaxBytes, bytes));
  }
  return ParseNetwork({std::istreambuf_iterator<char>(in), {}}, file.string());
}

}  // namespace windhover
