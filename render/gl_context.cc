#include "render/gl_context.h"

#include <array>
#include <cstdlib>
#include <mutex>
#include <stdexcept>

#include <GL/osmesa.h>
#include <dlfcn.h>
#include <fmt/format.h>

namespace windhover {
namespace {

// OSMesa wants a framebuffer of its own beside ours; nothing is drawn into it.
constexpr int kOwnSize_px = 16;

// Mesa makes its screen with the first context and reads its environment then.
std::mutex& CreationMutex() {
  static std::mutex mutex;
  return mutex;
}

// Loaded when it is first needed: OSMesa and LLVM take 45 MiB, which the other rasteriser and most
// programs do without. That stays loaded which threads may have begun to use.
struct OsMesa {
  OsMesa() {
    void* library = dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_LOCAL);
    if (library == nullptr) {
      throw std::runtime_error(fmt::format("{} (is libosmesa6 installed?)", dlerror()));
    }
    const auto find = [library](const char* name) {
      void* function = dlsym(library, name);
      if (function == nullptr) throw std::runtime_error(fmt::format("OSMesa lacks {}", name));
      return function;
    };
    create = reinterpret_cast<decltype(create)>(find("OSMesaCreateContextAttribs"));
    destroy = reinterpret_cast<decltype(destroy)>(find("OSMesaDestroyContext"));
    make_current = reinterpret_cast<decltype(make_current)>(find("OSMesaMakeCurrent"));
    proc_address = reinterpret_cast<decltype(proc_address)>(find("OSMesaGetProcAddress"));
  }

  decltype(&OSMesaCreateContextAttribs) create;
  decltype(&OSMesaDestroyContext) destroy;
  decltype(&OSMesaMakeCurrent) make_current;
  decltype(&OSMesaGetProcAddress) proc_address;
};

const OsMesa& Mesa() {
  static const OsMesa mesa;
  return mesa;
}

class OsMesaContext final : public GlContext {
 public:
  OsMesaContext() {
    const std::lock_guard lock(CreationMutex());
    setenv("LP_NUM_THREADS", "0", /*overwrite=*/1);
    constexpr int kAttributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_DEPTH_BITS,
                                   0,
                                   OSMESA_PROFILE,
                                   OSMESA_CORE_PROFILE,
                                   OSMESA_CONTEXT_MAJOR_VERSION,
                                   3,
                                   OSMESA_CONTEXT_MINOR_VERSION,
                                   3,
                                   0};
    context_ = Mesa().create(kAttributes, nullptr);
    if (context_ == nullptr) {
      throw std::runtime_error("OSMesa offers no OpenGL 3.3 core context (is libosmesa6 broken?)");
    }
    Load();
  }
  ~OsMesaContext() override {
    const std::lock_guard lock(CreationMutex());
    Mesa().destroy(context_);
  }

  void MakeCurrent() override {
    if (!Mesa().make_current(context_, own_framebuffer_.data(), GL_UNSIGNED_BYTE, kOwnSize_px,
                             kOwnSize_px)) {
      throw std::runtime_error("OSMesaMakeCurrent failed");
    }
  }

  void Release() override { Mesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

  const GlFunctions& gl() const override { return gl_; }

 private:
  void Load() {
#define WINDHOVER_GL_LOAD(type, name)                                 \
  gl_.name = reinterpret_cast<type>(Mesa().proc_address("gl" #name)); \
  if (gl_.name == nullptr) throw std::runtime_error("OSMesa lacks gl" #name);
    WINDHOVER_GL_FUNCTIONS(WINDHOVER_GL_LOAD)
#undef WINDHOVER_GL_LOAD
  }

  OSMesaContext context_ = nullptr;
  GlFunctions gl_;
  std::array<unsigned char, kOwnSize_px * kOwnSize_px * 4> own_framebuffer_{};
};

}  // namespace

std::unique_ptr<GlContext> MakeOsMesaContext() { return std::make_unique<OsMesaContext>(); }

std::string DescribeGl(const GlContext& context) {
  const auto text = [&](GLenum name) {
    const GLubyte* value = context.gl().GetString(name);
    return value == nullptr ? "?" : reinterpret_cast<const char*>(value);
  };
  return fmt::format("OpenGL {}, {}", text(GL_VERSION), text(GL_RENDERER));
}

}  // namespace windhover
