#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "render/gl_context.h"
#include "render/prepared_model.h"
#include "render/projected_mesh.h"
#include "render/target_layer.h"
#include "render/triangle_kernel.h"

namespace windhover {

/// A target in one pose, as it is to be drawn.
struct TargetDrawing {
  const ShadedTarget* target = nullptr;
  ProjectedMesh body, discs;
  std::vector<float> disc_alphas;  ///< One a vertex.
  ImageBounds bounds;              ///< Of body and discs.
};

/// Turns a target's triangles into samples: light and coverage at points of the image.
///
/// Serves one thread at a time, and any.
class TargetCanvas {
 public:
  /// Linear light times coverage, and coverage; 65535 is white, and opaque.
  using Pixel = std::array<std::uint16_t, 4>;

  virtual ~TargetCanvas() = default;

  /// What one Draw may show, in samples.
  struct TileLimits {
    int columns, rows, samples;
  };
  virtual TileLimits Limits() const = 0;

  /// Makes ready what the next calls of Draw show, which refer to `drawing`.
  virtual void Load(const TargetDrawing& drawing, int samples_per_px) = 0;

  /// Draws the pixels `shown`: the body, of which closed surfaces without their back faces, then
  /// the propellers' discs, blended in their order where nothing of the body is before them.
  /// @throws std::runtime_error after an OpenGL error.
  virtual void Draw(const PixelRect& shown) = 0;

  /// What was drawn, rows from the top; valid until the next call.
  virtual std::span<const Pixel> Samples() = 0;

  /// What covers the samples that were drawn, rows from the top.
  virtual void ReadCover(std::vector<TargetLayer::Sample>* cover);

  /// Adds the sum over the samples of each pixel to `sums`, whose rows are `stride` pixels apart.
  virtual void AddPixels(std::array<std::uint32_t, 4>* sums, std::ptrdiff_t stride);

 protected:
  /// Of coverage, from what a person or a detector might see on.
  static TargetLayer::Sample SampleOf(std::uint16_t coverage) {
    // Black blades before white clouds that cover 2 % change an image by five of 255 grey levels.
    constexpr std::uint16_t kVisible = 1311, kOpaque = 60000;
    using Sample = TargetLayer::Sample;
    return coverage < kVisible  ? Sample::kEmpty
           : coverage > kOpaque ? Sample::kOpaque
                                : Sample::kTranslucent;
  }

  PixelRect shown_;
  int samples_per_px_ = 1;
};

/// Draws with OpenGL, into a framebuffer of 16-bit linear RGBA with depth.
std::unique_ptr<TargetCanvas> MakeGlCanvas(std::unique_ptr<GlContext> context);

/// Draws with our own rasteriser (render/triangle_kernel.h); the same bits with each `isa`.
std::unique_ptr<TargetCanvas> MakeNativeCanvas(InstructionSet isa = WidestInstructionSet());

}  // namespace windhover
