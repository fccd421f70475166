#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "network/layer_table.h"
#include "network/onnx_graph.h"

namespace windhover {

/// A network, ready to run on `batch` images of one size.
class InferenceEngine {
 public:
  virtual ~InferenceEngine() = default;

  /// Runs the network on the calling thread alone. @param images batch × channels × height × width.
  virtual void Run(std::span<const float> images) = 0;

  /// What the last run gave as the table's output `i`: batch × channels × height × width.
  virtual std::span<const float> Output(std::size_t i) const = 0;
};

/// What an engine is made for.
struct InferenceTask {
  const LayerTable& table;
  const NetworkWeights& weights;
  std::vector<LayerShape> shapes;  ///< Of every layer (ShapesOf), for one image.
  int batch = 1;
};

/// What lies in a library of its own, windhover_inference.so: oneDNN, OpenCV's dnn and protobuf
/// with all that they depend on, which only trained detectors need.
struct InferenceLibrary {
  /// The parts of an .onnx file. @throws std::runtime_error if it is none.
  OnnxGraph (*parse_onnx)(std::string_view file);
  /// oneDNN: fast. Same bits in every run on processors with the same instructions; no wider ones
  /// than the environment variable WINDHOVER_ISA says.
  std::unique_ptr<InferenceEngine> (*make_onednn)(const InferenceTask& task);
  /// OpenCV's own reading of an .onnx file: the reference, three to four times slower.
  /// @throws std::exception of what OpenCV cannot read.
  std::unique_ptr<InferenceEngine> (*make_opencv)(const InferenceTask& task,
                                                  const std::string& onnx_file);
};

/// Loads the library at the first call, from any thread. @throws std::runtime_error if it cannot be
/// loaded.
const InferenceLibrary& Inference();

}  // namespace windhover
