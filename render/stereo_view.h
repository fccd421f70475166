#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "lcmtypes/world_truth_t.hpp"
#include "render/auto_exposure.h"
#include "render/eye_image.h"
#include "render/motion.h"
#include "render/scene_geometry.h"

namespace windhover {

struct StereoView;

/// One camera of one observer during one frame.
struct EyeView {
  explicit EyeView(const ExposureConfig& config)
      : exposure(config.auto_exposure, config.duration_ms * 1e-3) {}

  int index = 0;  ///< 0 left, 1 right.
  StereoView* observer = nullptr;
  std::optional<RayGrid> rays;
  AnyCamera camera;
  AutoExposure exposure;
  ExposureSetting setting{};
  ExposurePlan plan;
  std::vector<RowCameras> cameras;                            ///< One a sub-exposure.
  std::vector<std::vector<Eigen::Matrix3d>> R_WC_background;  ///< Likewise, of the background.
  std::optional<PointSpread> background_spread;
  std::vector<std::uint16_t> shading;
  std::vector<WarpGrid> warps;  ///< One a moment of R_WC_background.
  std::optional<BackgroundWarp> background;
  std::vector<std::uint16_t> linear;  ///< Linear light of the surroundings, where kept whole.
  std::vector<std::uint16_t> sharp;   ///< The same as a perfect lens shows them.
  std::vector<TargetLayer> layers;    ///< Far to near.
};

/// Both cameras of one observer during one frame, and the truth about what they see.
struct StereoView {
  StereoView(const ObserverRig& observer_rig, std::size_t observer_index,
             const ExposureConfig& exposure);

  /// The annotation's entry of the aircraft at `position` of the scenario.
  target_annotation_t& TargetAt(std::size_t position) {
    return annotation.targets[position - (position > rig.position ? 1 : 0)];
  }
  target_view_t& ViewOf(std::size_t position, const EyeView& eye) {
    return eye.index == 0 ? TargetAt(position).left : TargetAt(position).right;
  }
  /// Makes `window` hold all that both cameras see of the surroundings; they can be drawn then.
  void CoverSurroundings(RadianceMap* map, int threads);

  const ObserverRig& rig;
  std::size_t index;
  std::array<EyeView, 2> eyes;
  MapWindow window;

  StereoShutterTimes shutter;
  Chart chart{};
  double u_near = 0;
  annotation_t annotation{};
  std::vector<std::size_t> far_to_near;  ///< Positions of the other aircraft.
  std::vector<ShadedTarget> shaded;      ///< In that order; without a model if out of view.
};

/// Decides everything about the frame of `world` but its pixels: exposures, labels, where the
/// cameras are during their sub-exposures, which aircraft is in front.
void PlanFrame(const Scenario& scenario, const SceneGeometry& geometry, const RadianceMap& map,
               const world_truth_t& world, StereoView* view);

/// What a camera of `scenario` makes of points at a distance.
PointSpread SpreadAt(const Scenario& scenario, double distance_m, const EyeView& eye);

/// Where the rays of a camera meet the map, for each moment of the exposure.
void PlaceRays(const Scenario& scenario, const RadianceMap& map, EyeView* eye);

}  // namespace windhover
