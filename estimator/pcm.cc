#include "estimator/pcm.h"

#include <cmath>
#include <numbers>

namespace windhover {

std::optional<CorrectableBoxes> MakeCorrectable(const StereoRig& rig, const stereo_box_t& box) {
  const auto left = rig.left.Unproject({box.left.x_px, box.left.y_px});
  const auto right = rig.right.Unproject({box.right.x_px, box.right.y_px});
  if (!left || !right) return std::nullopt;
  const double f_px = rig.left.fx_px();
  CorrectableBoxes boxes{};
  const auto fill = [&](int side, const Eigen::Vector3d& ray, const image_box_t& seen) {
    boxes.x[side] = static_cast<float>(0.5 + f_px * (ray.x() / ray.z()) / rig.width_px);
    boxes.y[side] = static_cast<float>(0.5 + f_px * (ray.y() / ray.z()) / rig.height_px);
    boxes.w[side] = static_cast<float>(seen.w_px / rig.width_px);
    boxes.h[side] = static_cast<float>(seen.h_px / rig.height_px);
  };
  fill(0, *left, box.left);
  fill(1, *right, box.right);
  const Eigen::Vector2d middle = (left->hnormalized() + right->hnormalized()) / 2;
  boxes.range_m =
      static_cast<float>(f_px * rig.baseline_m / rig.width_px * middle.homogeneous().norm());
  boxes.image_width_px = static_cast<float>(rig.width_px);
  boxes.image_height_px = static_cast<float>(rig.height_px);
  return boxes;
}

Eigen::Vector3d RayOf(const CorrectableBoxes& boxes, const StereoRig& rig) {
  const double f_px = rig.left.fx_px();
  return Eigen::Vector3d((boxes.x[0] + boxes.x[1] - 1.0) / 2 * rig.width_px / f_px,
                         (boxes.y[0] + boxes.y[1] - 1.0) / 2 * rig.height_px / f_px, 1)
      .normalized();
}

BoxTokens TokensOf(const CorrectableBoxes& boxes, int side) {
  const float right_px = boxes.image_width_px * (boxes.x[side] - 0.5f);
  const float down_px = boxes.image_height_px * (boxes.y[side] - 0.5f);
  constexpr float kPi = std::numbers::pi_v<float>;
  const float turns = (kPi - std::atan2(right_px, down_px)) / (2 * kPi);
  const float diagonal_px = std::sqrt(boxes.image_width_px * boxes.image_width_px +
                                      boxes.image_height_px * boxes.image_height_px);
  const float radius = 2 * std::sqrt(right_px * right_px + down_px * down_px) / diagonal_px;
  return {turns >= 1 ? 0 : turns, radius, boxes.w[side], boxes.h[side]};
}

Correction Correct(const PcmStages& stages, const CorrectableBoxes& boxes, FurtherStages further) {
  Correction done{boxes, 0};
  for (std::size_t stage = 0; stage < stages.offsets.size(); ++stage) {
    const BoxTokens left = TokensOf(done.boxes, 0), right = TokensOf(done.boxes, 1);
    const bool alone = further == FurtherStages::kNone && stages.alone;
    const Mixer& mixer = alone ? *stages.alone : stages.offsets[stage];
    const auto offset = mixer.Evaluate(left, right);
    done.boxes.x[0] += offset[0][0];
    done.boxes.x[1] += offset[1][0];
    ++done.n_stages;
    if (further == FurtherStages::kNone || stage + 1 == stages.offsets.size()) break;
    if (further == FurtherStages::kForAll) continue;
    const auto logits = stages.gates[stage].Evaluate(left, right);
    const float easy = (logits[0][0] + logits[1][0]) / 2, hard = (logits[0][1] + logits[1][1]) / 2;
    if (!(hard > easy)) break;
  }
  return done;
}

PositionCorrection::PositionCorrection(const AircraftConfig& config, PcmStages stages,
                                       FurtherStages further)
    : rig_(config.rig.ToStereoRig()), stages_(std::move(stages)), further_(further) {}

std::optional<RangeSolution> PositionCorrection::Solve(const StereoObservation& observation) {
  const auto boxes = MakeCorrectable(rig_, observation.box);
  if (!boxes) return std::nullopt;
  const Correction corrected = Correct(stages_, *boxes, further_);
  const float disparity = corrected.boxes.Disparity();
  if (!(disparity > 0)) return std::nullopt;
  const double range_m = boxes->Range_m(disparity);
  return RangeSolution{range_m * RayOf(*boxes, rig_), range_m,
                       range_m * stages_.range_sigma[static_cast<std::size_t>(further_)],
                       corrected.n_stages};
}

}  // namespace windhover
