#pragma once

#include <memory>

#include "network/inference.h"

namespace windhover {

/// Part of windhover_inference.so: InferenceLibrary::make_onednn.
std::unique_ptr<InferenceEngine> MakeOneDnnEngine(const InferenceTask& task);

}  // namespace windhover
