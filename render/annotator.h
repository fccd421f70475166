#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "camera/any_camera.h"
#include "lcmtypes/target_annotation_t.hpp"
#include "render/outline.h"
#include "render/row_poses.h"
#include "render/target_pass.h"

namespace windhover {

/// What geometry alone says of a target in one camera of width × height px: its full box (around
/// the projections of `outline`), centre and truncation. `visible` is the full box cut at the
/// image's borders, `occlusion` 0: as if nothing else were there.
target_view_t ViewFromGeometry(const Outline& outline, const RowPoses& X_CB,
                               const AnyCamera& camera, int width_px, int height_px);

/// Replaces `visible` and `occlusion` of a view by what was drawn: the box around the samples of
/// `layers[i]` that no layer after it (nearer) covers opaquely, and the share of those covered.
void SetVisibility(std::span<const TargetLayer> layers, std::size_t i, target_view_t* view);

}  // namespace windhover
