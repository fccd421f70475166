#pragma once

#include <cstdint>

#include "camera/stereo_rig.h"
#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/detection_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

// Detections that are made of annotations, without an image. All are ordered best first, then
// from left to right, and carry no identity.

/// observe: annotated. The visible boxes of every target that both cameras see; the score is the
/// share of the target that is visible in the eye that sees less.
detection_t DetectVisible(const annotation_t& annotation);

/// observe: geometric. The full boxes of every target whose centre is in both images, with noise,
/// that of rig/box_noise.h. It is a function of seed, observer, target and tick alone. Occlusion
/// plays no part.
detection_t DetectGeometric(const annotation_t& annotation, const GeometricConfig& config,
                            std::uint64_t seed, int tick, int width_px, int height_px);

/// observe: truth. Boxes whose centres triangulate with the calibrated rig to the target's exact
/// place, with the sizes of the full boxes; of every target whose centre is in both images.
detection_t DetectTruth(const annotation_t& annotation, const StereoRig& calibrated);

}  // namespace windhover
