#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "render/gl_context.h"
#include "render/prepared_model.h"
#include "render/projected_mesh.h"

namespace windhover {

/// One target as one camera sees it during one exposure, without the others.
struct TargetLayer {
  PixelRect roi;
  PixelRect spread_roi;  ///< Of `pixels`, where a lens spread them beyond the samples; else empty.
  /// Linear light times coverage (65535 is white) and coverage; mean over the exposure.
  std::vector<std::array<std::uint16_t, 4>> pixels;
  /// Samples of the middle of the exposure, samples_per_px² a pixel, rows from the top.
  int samples_per_px = 1;
  enum class Sample : std::uint8_t { kEmpty, kTranslucent, kOpaque };
  std::vector<Sample> samples;

  /// Where `pixels` are.
  const PixelRect& PixelRegion() const { return spread_roi.IsEmpty() ? roi : spread_roi; }

  Sample SampleAt(double x_px, double y_px) const;
};

/// Draws aircraft with OpenGL: only the region that an aircraft covers, supersampled, with the
/// lens's distortion applied to its vertices.
///
/// One per thread that draws.
class TargetPass {
 public:
  /// `max_blur_px`: relative motion of a target's parts that one drawing may hide.
  TargetPass(std::unique_ptr<GlContext> context, double max_blur_px);
  ~TargetPass();
  TargetPass(const TargetPass&) = delete;

  /// Draws `target` from the poses `X_CB` (sub-exposures, row by row; the middle one is the middle
  /// of the exposure) into an image of width × height px. Where its parts move against each other
  /// by no more than max_blur_px, it is drawn once and its samples are moved by whole samples.
  /// `rotors`: during the exposure, of which sub-exposures are equal parts.
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
  struct Gl;
  std::unique_ptr<Gl> gl_;
  double max_blur_px_;
};

}  // namespace windhover
