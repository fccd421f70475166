#pragma once

#include <array>
#include <optional>
#include <vector>

#include "camera/stereo_rig.h"
#include "estimator/mixer.h"
#include "estimator/range_estimator.h"

namespace windhover {

/// A stereo detection as corrections see it; index 0 is the left camera. Positions and sizes are
/// in shares of the image's width and height, undistorted, with the principal point at 1/2.
struct CorrectableBoxes {
  std::array<float, 2> x, y, w, h;
  float range_m;  ///< Range times disparity in shares of the width: f · baseline · |ray| / width.
  float image_width_px, image_height_px;

  /// Distance from the middle of the baseline, along the observed ray: corrections are trained on
  /// distances, which only tell the difference of both offsets, not where the target is.
  float Range_m(float disparity) const { return range_m / disparity; }
  float Disparity() const { return x[0] - x[1]; }
};

/// @return nothing where a pixel has no ray. Focal length and baseline are those of `rig`.
std::optional<CorrectableBoxes> MakeCorrectable(const StereoRig& rig, const stereo_box_t& box);

/// Unit vector in R towards the middle of both centres, as observed by `rig`.
Eigen::Vector3d RayOf(const CorrectableBoxes& boxes, const StereoRig& rig);

/// The 4-tuple of one camera. Angles run clockwise from below, as in the authors' code.
BoxTokens TokensOf(const CorrectableBoxes& boxes, int side);

/// Which samples get another correction.
enum class FurtherStages {
  kNone,    ///< `pcm`
  kByGate,  ///< `pcm_dic`
  kForAll,  ///< `pcm_dic_star`
};

/// The position correction modules of an estimator, one a stage, with a gate between two.
struct PcmStages {
  std::vector<Mixer> offsets;  ///< One output each; at least one stage.
  std::vector<Mixer> gates;    ///< Two outputs each, easy and hard; one fewer.
  std::optional<Mixer> alone;  ///< What `pcm` takes instead of the first of `offsets`.
  /// Relative standard deviation of the range: of `pcm`, `pcm_dic`, `pcm_dic_star`.
  std::array<double, 3> range_sigma = {0.1, 0.1, 0.1};
};

/// The paper's Algorithm 1 from the 4-tuples on: each stage adds the offsets of its module to the
/// positions; then the gate's logits, averaged over both cameras, say whether the sample is hard
/// and another stage follows.
struct Correction {
  CorrectableBoxes boxes;  ///< With the corrected positions.
  int n_stages;
};
Correction Correct(const PcmStages& stages, const CorrectableBoxes& boxes, FurtherStages further);

/// `pcm`, `pcm_dic` and `pcm_dic_star`: triangulation of corrected positions. A correction that
/// leaves no parallax is no estimate.
/// Source: the paper, section IV, Algorithm 1.
class PositionCorrection final : public RangeEstimator {
 public:
  PositionCorrection(const AircraftConfig& config, PcmStages stages, FurtherStages further);

 private:
  std::optional<RangeSolution> Solve(const StereoObservation& observation) override;

  StereoRig rig_;
  PcmStages stages_;
  FurtherStages further_;
};

}  // namespace windhover
