#include "render/target_canvas.h"

#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace windhover {
namespace {

constexpr char kVertexShader[] = R"(#version 330 core
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 light;
out vec4 shade;
void main() { gl_Position = vec4(place, 1.0); shade = light; }
)";
constexpr char kFragmentShader[] = R"(#version 330 core
in vec4 shade;
out vec4 light;
void main() { light = shade; }
)";

}  // namespace

TargetCanvas::TargetCanvas(std::unique_ptr<GlContext> context)
    : context_(std::move(context)), gl_(context_->gl()) {
  context_->MakeCurrent();
  MakeProgram();
  MakeBuffers();
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL offers no 16-bit framebuffer: " + DescribeGl(*context_));
  }
}

TargetCanvas::~TargetCanvas() {
  try {
    context_->MakeCurrent();
  } catch (const std::runtime_error&) {
    return;  // The context takes its objects with it.
  }
  gl_.DeleteProgram(program_);
  gl_.DeleteVertexArrays(1, &vertex_array_);
  gl_.DeleteBuffers(1, &vertex_buffer_);
  gl_.DeleteBuffers(1, &index_buffer_);
  gl_.DeleteFramebuffers(1, &framebuffer_);
  gl_.DeleteRenderbuffers(1, &colour_);
  gl_.DeleteRenderbuffers(1, &depth_);
}

GLuint TargetCanvas::Compile(GLenum type, const char* source) {
  const GLuint shader = gl_.CreateShader(type);
  gl_.ShaderSource(shader, 1, &source, nullptr);
  gl_.CompileShader(shader);
  gl_.AttachShader(program_, shader);
  return shader;
}

void TargetCanvas::MakeProgram() {
  program_ = gl_.CreateProgram();
  const GLuint vertex = Compile(GL_VERTEX_SHADER, kVertexShader);
  const GLuint fragment = Compile(GL_FRAGMENT_SHADER, kFragmentShader);
  gl_.LinkProgram(program_);
  gl_.DeleteShader(vertex);
  gl_.DeleteShader(fragment);
  GLint linked = 0;
  gl_.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (linked == 0) throw std::runtime_error("OpenGL cannot link the target's shaders");
}

void TargetCanvas::MakeBuffers() {
  gl_.GenVertexArrays(1, &vertex_array_);
  gl_.BindVertexArray(vertex_array_);
  gl_.GenBuffers(1, &vertex_buffer_);
  gl_.GenBuffers(1, &index_buffer_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer_);
  constexpr GLsizei kStride = sizeof(CanvasVertex);
  gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
  gl_.VertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, kStride,
                          reinterpret_cast<const void*>(offsetof(CanvasVertex, red)));
  gl_.EnableVertexAttribArray(0);
  gl_.EnableVertexAttribArray(1);
  gl_.GenRenderbuffers(1, &colour_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, colour_);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA16, kMaxSize, kMaxSize);
  gl_.GenRenderbuffers(1, &depth_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, kMaxSize, kMaxSize);
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
}

void TargetCanvas::Begin(int width, int height) {
  if (width > kMaxSize || height > kMaxSize) throw std::logic_error("TargetCanvas is too small");
  context_->MakeCurrent();
  width_ = width;
  height_ = height;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.BindVertexArray(vertex_array_);
  gl_.UseProgram(program_);
  gl_.Viewport(0, 0, width, height);
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(0, 0, width, height);
  gl_.DepthMask(GL_TRUE);
  gl_.ClearColor(0, 0, 0, 0);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(GL_LESS);
  // y is down, so what is counter-clockwise on the aircraft is clockwise for OpenGL.
  gl_.FrontFace(GL_CW);
  gl_.CullFace(GL_BACK);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
}

void TargetCanvas::Draw(Surface surface, const std::vector<CanvasVertex>& vertices,
                        const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (triangles.empty()) return;
  const bool is_translucent = surface == Surface::kTranslucent;
  (surface == Surface::kOpen ? gl_.Disable : gl_.Enable)(GL_CULL_FACE);
  (is_translucent ? gl_.Enable : gl_.Disable)(GL_BLEND);
  gl_.DepthMask(is_translucent ? GL_FALSE : GL_TRUE);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof vertices[0]),
                 vertices.data(), GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER,
                 static_cast<GLsizeiptr>(triangles.size() * sizeof triangles[0]), triangles.data(),
                 GL_STREAM_DRAW);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(triangles.size() * 3), GL_UNSIGNED_INT,
                   nullptr);
}

void TargetCanvas::Read(std::vector<Pixel>* pixels) {
  pixels->resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 8);
  gl_.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_SHORT, pixels->data());
  if (const GLenum error = gl_.GetError(); error != GL_NO_ERROR) {
    throw std::runtime_error(fmt::format("OpenGL error 0x{:x} while drawing a target", error));
  }
}

}  // namespace windhover
