#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "lcmtypes/image_box_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/scene_geometry.h"
#include "scenarios/scenario.h"

namespace windhover {

class StereoRenderer;

/// What a detector looks for: our aircraft, or a quadrotor unlike every other. None learns from
/// the last two, unless it is fine-tuned.
enum class TargetKind { kM200Orange, kM200Black, kP600, kQuadrotor, kHexacopter, kFlyingWing };
template <>
inline constexpr EnumNames<TargetKind> kEnumNames<TargetKind>{
    {TargetKind::kM200Orange, "m200_orange"},
    {TargetKind::kM200Black, "m200_black"},
    {TargetKind::kP600, "p600"},
    {TargetKind::kQuadrotor, "quadrotor"},
    {TargetKind::kHexacopter, "hexacopter"},
    {TargetKind::kFlyingWing, "flying_wing"}};

/// Which pictures of aircraft are drawn.
struct PictureConfig {
  std::uint64_t seed = 1;
  Split split = Split::kTrain;  ///< Surroundings are those of a data set's split.
  /// Panoramas and photos, each as likely as a drawn environment of the split.
  std::vector<EnvironmentConfig> backgrounds;
  std::vector<TargetKind> targets = {TargetKind::kM200Orange, TargetKind::kM200Black,
                                     TargetKind::kP600, TargetKind::kQuadrotor};
  double nearest_m = 3, farthest_m = 45;  ///< Of the target; as many in each octave.
  double empty_share = 0.2;               ///< Pairs without a target.
  int most_distractors = 4;  ///< Birds, aeroplanes, trees, clutter; in a scene, in turn in view.
  int pairs = 24;            ///< Of a scene.
  /// Light, exposure, turning and sensor vary far more than in any one flight, in place of the
  /// rig's vibration and bending.
  bool is_randomised = true;
};

/// One camera's picture and what is in it.
struct LabelledPicture {
  cv::Mat rgb;                     ///< 8 bit, red, green, blue; as received from the camera.
  std::optional<image_box_t> box;  ///< The target's visible box, px; nothing: none is seen.
  double occlusion = 0, truncation = 0;
};

struct LabelledPair {
  std::array<LabelledPicture, 2> eyes;  ///< Left, right.
  TargetKind kind{};
  double range_m = 0;  ///< From the middle of the baseline to the target's centre.
};

/// One place and time with aircraft in it, before a pixel is drawn. Aircraft 0 carries the rig, 1
/// is the target; others distract.
struct PicturePlan {
  Scenario scenario;
  GivenShapes shapes;
  TargetKind kind{};
  std::vector<world_truth_t> worlds;  ///< One a pair; who is not in view is behind the rig.
};

/// Scene number `scene` (from 0), a function of its arguments alone. The rig, and all that
/// `randomize` of `base` lists, are drawn as for a flight of a data set (scenarios/dataset.h);
/// poses are drawn directly, as nothing in a picture needs them to be flown.
PicturePlan PlanPictures(const Scenario& base, const PictureConfig& config, int scene);

/// Draws the pairs of a scene.
class PictureScene {
 public:
  /// @throws ConfigError if a background's image cannot be used.
  PictureScene(const Scenario& base, const PictureConfig& config, int scene);
  ~PictureScene();

  int size() const { return static_cast<int>(plan_.worlds.size()); }
  /// Pair `i`, a function of the scene and i alone.
  LabelledPair Draw(int i);

 private:
  PicturePlan plan_;
  std::unique_ptr<StereoRenderer> renderer_;
};

}  // namespace windhover
