#pragma once

#include <memory>
#include <string>

#include "render/gl_functions.h"

namespace windhover {

/// An OpenGL 3.3 core context without a window. What is drawn goes to framebuffer objects; the
/// context's own framebuffer stays empty.
///
/// A context serves one thread at a time.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes the context current on the calling thread. @throws std::runtime_error if it cannot.
  virtual void MakeCurrent() = 0;

  /// Makes no context current on the calling thread, so that another one may use this.
  virtual void Release() = 0;

  /// The GL functions; call them only on the thread on which the context is current.
  virtual const GlFunctions& gl() const = 0;
};

/// A context on Mesa's software renderer, which needs neither a GPU nor a display.
///
/// Rasterises on the calling thread (LP_NUM_THREADS=0), so the caller's threads are the only
/// ones; llvmpipe's output does not depend on that number.
/// @throws std::runtime_error if OSMesa offers no GL 3.3 core context.
std::unique_ptr<GlContext> MakeOsMesaContext();

/// "OpenGL VERSION, RENDERER" of a context that is current.
std::string DescribeGl(const GlContext& context);

}  // namespace windhover
