#pragma once

#include <memory>
#include <string>

#include "network/inference.h"

namespace windhover {

/// Part of windhover_inference.so: InferenceLibrary::make_opencv.
std::unique_ptr<InferenceEngine> MakeOpenCvEngine(const InferenceTask& task,
                                                  const std::string& onnx_file);

}  // namespace windhover
