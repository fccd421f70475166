#pragma once

#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "render/gl_context.h"
#include "render/layer_sum.h"
#include "render/prepared_model.h"
#include "render/projected_mesh.h"
#include "render/target_canvas.h"
#include "render/target_layer.h"
#include "scenarios/render_config.h"

namespace windhover {

/// Draws aircraft: only the region that an aircraft covers, supersampled, with the lens's
/// distortion applied to its vertices.
///
/// One per thread that draws.
class TargetPass {
 public:
  /// `max_blur_px`: relative motion of a target's parts that one drawing may hide.
  TargetPass(std::unique_ptr<TargetCanvas> canvas, double max_blur_px);
  /// With OpenGL.
  TargetPass(std::unique_ptr<GlContext> context, double max_blur_px);
  ~TargetPass();
  TargetPass(const TargetPass&) = delete;

  /// Draws `target` from the poses `X_CB` (sub-exposures, row by row; the middle one is the middle
  /// of the exposure) into an image of width × height px. Sub-exposures between which its parts
  /// move against each other by no more than max_blur_px are drawn once, and the samples are moved
  /// by whole samples. `rotors`: during the exposure, of which sub-exposures are equal parts.
  /// @return an empty layer if the target is not in the image.
  TargetLayer Draw(const ShadedTarget& target, const AnyCamera& camera, int width_px, int height_px,
                   std::span<const RowPoses> X_CB, const RotorTurning& rotors);
  /// The same for a global shutter.
  TargetLayer Draw(const ShadedTarget& target, const AnyCamera& camera, int width_px, int height_px,
                   std::span<const Eigen::Isometry3d> X_CB, const RotorTurning& rotors) {
    const std::vector<RowPoses> poses(X_CB.begin(), X_CB.end());
    return Draw(target, camera, width_px, height_px, std::span<const RowPoses>(poses), rotors);
  }

 private:
  struct Gathering;
  void Gather(const TargetDrawing& drawing, Gathering* gathering);

  std::unique_ptr<TargetCanvas> canvas_;
  double max_blur_px_;
  std::vector<TargetLayer::Sample> cover_;
  BoxSums boxes_;
};

/// A pass that draws with `rasteriser`. OpenGL's draws for one thread of the process at a time
/// (Mesa's lock); passes of our own draw side by side.
/// @throws std::runtime_error if OSMesa offers no GL 3.3 core context.
std::unique_ptr<TargetPass> MakeTargetPass(Rasteriser rasteriser, double max_blur_px);

}  // namespace windhover
