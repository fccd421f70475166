#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

#include "render/target_canvas.h"

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

enum class Surface { kClosed, kOpen, kTranslucent };

// A vertex on the canvas: x, y, z in -1..1, y down; light times coverage, and coverage.
struct CanvasVertex {
  float x, y, z;
  float red, green, blue, alpha;
};

// From image coordinates to a canvas that shows `rect`. Depth is affine in 1 / Z, which is
// affine in the image, so that interpolation between vertices is exact.
class CanvasMap {
 public:
  CanvasMap(const PixelRect& rect, const ImageBounds& bounds) : rect_(rect) {
    const double margin = 1e-3 * bounds.inverse_near;
    near_ = bounds.inverse_near + margin;
    far_ = std::max(bounds.inverse_far - margin, 0.0);
  }

  CanvasVertex Vertex(const ProjectedMesh& mesh, std::size_t i, const Eigen::Vector3f& light,
                      float alpha) const {
    const double inverse_depth = mesh.inverse_depth_per_m[i];
    return {static_cast<float>(2 * (mesh.x_px[i] - rect_.x0 + 0.5) / rect_.width - 1),
            static_cast<float>(2 * (mesh.y_px[i] - rect_.y0 + 0.5) / rect_.height - 1),
            static_cast<float>((near_ + far_ - 2 * inverse_depth) / (near_ - far_)),
            light.x() * alpha,
            light.y() * alpha,
            light.z() * alpha,
            alpha};
  }

 private:
  PixelRect rect_;
  double near_, far_;
};

// `alphas`: one a vertex, or none where all is opaque.
std::vector<CanvasVertex> OnCanvas(const ProjectedMesh& mesh,
                                   const std::vector<Eigen::Vector3f>& light,
                                   const std::vector<float>& alphas, const CanvasMap& map) {
  std::vector<CanvasVertex> vertices;
  vertices.reserve(mesh.x_px.size());
  for (std::size_t i = 0; i < mesh.x_px.size(); ++i) {
    vertices.push_back(map.Vertex(mesh, i, light[i], alphas.empty() ? 1 : alphas[i]));
  }
  return vertices;
}

class GlCanvas final : public TargetCanvas {
 public:
  explicit GlCanvas(std::unique_ptr<GlContext> context);
  ~GlCanvas() override;

  TileLimits Limits() const override { return {kMaxColumns, kMaxRows, kMaxColumns * kMaxRows}; }
  void Load(const TargetDrawing& drawing, int samples_per_px) override {
    drawing_ = &drawing;
    samples_per_px_ = samples_per_px;
  }
  void Draw(const PixelRect& shown) override;
  std::span<const Pixel> Samples() override { return samples_; }

 private:
  static constexpr int kMaxColumns = 2048, kMaxRows = 1024;  // 24 MiB.
  static constexpr int kStep = 256;                          // In which the buffers grow.

  void MakeProgram();
  void MakeBuffers();
  GLuint Compile(GLenum type, const char* source);
  void Grow(int width, int height);
  void Begin(int width, int height);
  void DrawSurface(Surface surface, const std::vector<CanvasVertex>& vertices,
                   const ProjectedMesh::Triangles& triangles);
  void Read(int width, int height);

  std::unique_ptr<GlContext> context_;
  const GlFunctions& gl_;
  GLuint program_ = 0, vertex_array_ = 0, vertex_buffer_ = 0, index_buffer_ = 0;
  GLuint framebuffer_ = 0, colour_ = 0, depth_ = 0;
  int columns_ = 0, rows_ = 0;  // Of colour_ and depth_.
  const TargetDrawing* drawing_ = nullptr;
  std::vector<Pixel> samples_;
};

GlCanvas::GlCanvas(std::unique_ptr<GlContext> context)
    : context_(std::move(context)), gl_(context_->gl()) {
  context_->MakeCurrent();
  MakeProgram();
  MakeBuffers();
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL offers no 16-bit framebuffer: " + DescribeGl(*context_));
  }
  context_->Release();
}

GlCanvas::~GlCanvas() {
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

GLuint GlCanvas::Compile(GLenum type, const char* source) {
  const GLuint shader = gl_.CreateShader(type);
  gl_.ShaderSource(shader, 1, &source, nullptr);
  gl_.CompileShader(shader);
  gl_.AttachShader(program_, shader);
  return shader;
}

void GlCanvas::MakeProgram() {
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

void GlCanvas::MakeBuffers() {
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
  gl_.GenRenderbuffers(1, &depth_);
  Grow(kStep, kStep);
  gl_.GenFramebuffers(1, &framebuffer_);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
}

// Most targets need a small part of the largest buffers.
void GlCanvas::Grow(int width, int height) {
  columns_ = std::max(columns_, (width + kStep - 1) / kStep * kStep);
  rows_ = std::max(rows_, (height + kStep - 1) / kStep * kStep);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, colour_);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA16, columns_, rows_);
  gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_);
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, columns_, rows_);
}

void GlCanvas::Begin(int width, int height) {
  if (width > kMaxColumns || height > kMaxRows) throw std::logic_error("GlCanvas is too small");
  context_->MakeCurrent();
  if (width > columns_ || height > rows_) Grow(width, height);
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

void GlCanvas::DrawSurface(Surface surface, const std::vector<CanvasVertex>& vertices,
                           const ProjectedMesh::Triangles& triangles) {
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

void GlCanvas::Read(int width, int height) {
  samples_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 8);
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_SHORT, samples_.data());
  if (const GLenum error = gl_.GetError(); error != GL_NO_ERROR) {
    throw std::runtime_error(fmt::format("OpenGL error 0x{:x} while drawing a target", error));
  }
}

void GlCanvas::Draw(const PixelRect& shown) {
  const ShadedTarget& target = *drawing_->target;
  const CanvasMap map(shown, drawing_->bounds);
  shown_ = shown;
  const int width = shown.width * samples_per_px_, height = shown.height * samples_per_px_;
  Begin(width, height);
  DrawSurface(target.model->IsWatertight() ? Surface::kClosed : Surface::kOpen,
              OnCanvas(drawing_->body, target.body_light, {}, map), drawing_->body.SeenTriangles());
  DrawSurface(Surface::kTranslucent,
              OnCanvas(drawing_->discs, target.disc_light, drawing_->disc_alphas, map),
              drawing_->discs.SeenTriangles());
  Read(width, height);
  context_->Release();
}

}  // namespace

std::unique_ptr<TargetCanvas> MakeGlCanvas(std::unique_ptr<GlContext> context) {
  return std::make_unique<GlCanvas>(std::move(context));
}

}  // namespace windhover
