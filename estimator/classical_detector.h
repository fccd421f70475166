#pragma once

#include <optional>
#include <vector>

#include "estimator/background_alignment.h"
#include "estimator/detector.h"
#include "estimator/target_segmenter.h"

namespace windhover {

/// Finds aircraft without learning: by their parallax against a far background.
///
/// At a quarter of the resolution the backgrounds are laid over each other; what then differs in
/// both images, a common parallax apart, is a target (ParallaxEvidence). Around each target the
/// same is done again at a resolution that fits its size, which gives the left box. The right
/// box is the left one, moved by the shift at which the target's own pixels match best, to a
/// fraction of a pixel. Spinning propellers are too faint to be seen: boxes end at the motors.
///
/// The background must be far: with the paper's rig, what is nearer than 80 m stands out like a
/// target. A small target before or behind a much larger one is taken for a part of it.
class ClassicalDetector final : public Detector {
 public:
  /// @throws std::invalid_argument if the images are not 8-bit RGB of one size, at least
  /// 64 × 64 px.
  std::vector<stereo_box_t> Detect(const cv::Mat& left_rgb, const cv::Mat& right_rgb) override;

 private:
  std::optional<stereo_box_t> Refine(const cv::Mat& left_rgb, const cv::Mat& right_rgb,
                                     const Segment& coarse, cv::Point background_shift_px) const;
};

}  // namespace windhover
