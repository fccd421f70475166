#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "render/gl_context.h"

namespace windhover {

/// A vertex on the canvas: x, y, z in -1..1, y down; light times coverage, and coverage.
struct CanvasVertex {
  float x, y, z;
  float red, green, blue, alpha;
};

/// A framebuffer of 16-bit linear RGBA with depth, into which triangles are drawn flat.
class TargetCanvas {
 public:
  using Pixel = std::array<std::uint16_t, 4>;
  enum class Surface { kClosed, kOpen, kTranslucent };

  explicit TargetCanvas(std::unique_ptr<GlContext> context);
  ~TargetCanvas();
  TargetCanvas(const TargetCanvas&) = delete;

  /// Makes the canvas ready on this thread, empty, `width` × `height`; at most kMaxSize.
  void Begin(int width, int height);
  /// Draws triangles: closed and translucent surfaces without their back faces, translucent ones
  /// over what is there and without hiding what comes after.
  void Draw(Surface surface, const std::vector<CanvasVertex>& vertices,
            const std::vector<std::array<std::uint32_t, 3>>& triangles);
  /// Copies the canvas, rows from the top. @throws std::runtime_error after an OpenGL error.
  void Read(std::vector<Pixel>* pixels);

  static constexpr int kMaxSize = 2048;

 private:
  void MakeProgram();
  void MakeBuffers();
  GLuint Compile(GLenum type, const char* source);

  std::unique_ptr<GlContext> context_;
  const GlFunctions& gl_;
  GLuint program_ = 0, vertex_array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0;
  GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
};

}  // namespace windhover
