#include "common/image/image_codecs.h"

#include <stdexcept>

#include <dlfcn.h>
#include <fmt/format.h>

namespace windhover {
namespace {

const ImageCodecs* Load() {
  // Found beside the programs: CMAKE_BUILD_RPATH.
  void* library = dlopen("windhover_codecs.so", RTLD_LAZY | RTLD_LOCAL);
  const void* codecs = library == nullptr ? nullptr : dlsym(library, "windhover_image_codecs");
  if (codecs == nullptr) throw std::runtime_error(fmt::format("image codecs: {}", dlerror()));
  return static_cast<const ImageCodecs*>(codecs);
}

}  // namespace

const ImageCodecs& Codecs() {
  static const ImageCodecs* codecs = Load();
  return *codecs;
}

}  // namespace windhover
