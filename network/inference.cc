#include "network/inference.h"

#include <stdexcept>

#include <dlfcn.h>
#include <fmt/format.h>

namespace windhover {
namespace {

const InferenceLibrary* Load() {
  // Found beside the programs: CMAKE_BUILD_RPATH.
  void* library = dlopen("windhover_inference.so", RTLD_LAZY | RTLD_LOCAL);
  const void* inference = library == nullptr ? nullptr : dlsym(library, "windhover_inference");
  if (inference == nullptr) throw std::runtime_error(fmt::format("inference: {}", dlerror()));
  return static_cast<const InferenceLibrary*>(inference);
}

}  // namespace

const InferenceLibrary& Inference() {
  static const InferenceLibrary* inference = Load();
  return *inference;
}

}  // namespace windhover
