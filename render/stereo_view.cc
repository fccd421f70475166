#include "render/stereo_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace windhover {
namespace {

// Where the cameras are during their sub-exposures, which are the same for both where they expose
// equally long.
void PlaceEyes(const Scenario& scenario, const world_truth_t& world, StereoView* observer) {
  const ObserverRig& rig = observer->rig;
  const double focal_px = scenario.rig.calibrated.FocalPx();
  const auto [width_px, height_px] = scenario.rig.calibrated.image;
  auto& eyes = observer->eyes;
  const bool is_alike = eyes[0].setting.duration_s == eyes[1].setting.duration_s;
  for (EyeView& eye : eyes) {
    eye.cameras.clear();
    eye.R_WC_background.clear();
    eye.plan = is_alike && eye.index == 1 ? eyes[0].plan
                                          : PlanExposure(scenario.exposure, eye.setting.duration_s,
                                                         world, rig.position, rig.motion, focal_px);
  }
  const auto cameras_at = [&, height = height_px](double offset_s) {
    return CamerasByRows(world, rig.position, rig.X_BR, rig.motion, observer->shutter, height,
                         offset_s);
  };
  const auto orientations = [](const RowCameras& cameras) {
    std::vector<Eigen::Matrix3d> R_WC;
    for (const Eigen::Isometry3d& X_WC : cameras.X_WC) R_WC.push_back(X_WC.linear());
    return R_WC;
  };
  for (std::size_t lead = 0; lead < (is_alike ? 1u : 2u); ++lead) {
    const bool left = lead == 0, right = lead == 1 || is_alike;
    for (const ExposureNode& node : eyes[lead].plan.background) {
      const StereoRowCameras cameras = cameras_at(node.offset_s);
      if (left) eyes[0].R_WC_background.push_back(orientations(cameras.left));
      if (right) eyes[1].R_WC_background.push_back(orientations(cameras.right));
    }
    for (const double offset_s : eyes[lead].plan.offsets_s) {
      const StereoRowCameras cameras = cameras_at(offset_s);
      if (left) eyes[0].cameras.push_back(cameras.left);
      if (right) eyes[1].cameras.push_back(cameras.right);
    }
  }
  for (EyeView& eye : eyes) eye.camera = eye.cameras.front().camera;
}

void SortFarToNear(std::size_t n_aircraft, StereoView* observer) {
  const std::size_t own = observer->rig.position;
  observer->far_to_near.clear();
  for (std::size_t i = 0; i < n_aircraft; ++i) {
    if (i != own) observer->far_to_near.push_back(i);
  }
  std::stable_sort(observer->far_to_near.begin(), observer->far_to_near.end(),
                   [observer](std::size_t a, std::size_t b) {
                     return observer->TargetAt(a).range_m > observer->TargetAt(b).range_m;
                   });
}

}  // namespace

StereoView::StereoView(const ObserverRig& observer_rig, std::size_t observer_index,
                       const ExposureConfig& exposure)
    : rig(observer_rig), index(observer_index), eyes{EyeView(exposure), EyeView(exposure)} {
  eyes[1].index = 1;
  for (EyeView& eye : eyes) eye.observer = this;
}

void StereoView::CoverSurroundings(RadianceMap* map, int threads) {
  double u_min = 1e18, u_max = -1e18, v_min = 1e18, v_max = -1e18;
  for (const EyeView& eye : eyes) {
    for (const WarpGrid& warp : eye.warps) {
      u_min = std::min(u_min, warp.u_min);
      u_max = std::max(u_max, warp.u_max);
      v_min = std::min(v_min, warp.v_min);
      v_max = std::max(v_max, warp.v_max);
    }
  }
  const auto low = [](double v) { return static_cast<int>(std::floor(v)) - 1; };
  const auto high = [](double v) { return static_cast<int>(std::ceil(v)) + 2; };
  map->Cover(chart, low(u_min), high(u_max), low(v_min), high(v_max), threads, &window);
  for (EyeView& eye : eyes) eye.background.emplace(*eye.rays, eye.warps, *map, window);
}

void PlanFrame(const Scenario& scenario, const SceneGeometry& geometry, const RadianceMap& map,
               const world_truth_t& world, StereoView* view) {
  const ObserverRig& rig = view->rig;
  for (EyeView& eye : view->eyes) {
    const bool is_led = scenario.exposure.auto_exposure.mode == AutoExposureMode::kShared;
    eye.setting = view->eyes[is_led ? 0 : eye.index].exposure.Setting();
  }
  view->shutter = geometry.ShutterOf(world, view->index, view->eyes[0].setting.duration_s,
                                     view->eyes[1].setting.duration_s);
  view->annotation = geometry.Annotate(world, view->index, view->shutter);
  const Eigen::Vector3d axis_W = (PoseAt(world.uavs[rig.position], 0) * rig.X_BR).linear().col(2);
  view->chart = ChartFor(axis_W);
  view->u_near = map.PlaceOf(axis_W, view->chart).x();
  PlaceEyes(scenario, world, view);
  SortFarToNear(scenario.aircraft.size(), view);
}

PointSpread SpreadAt(const Scenario& scenario, double distance_m, const EyeView& eye) {
  const OpticsConfig& optics = scenario.optics;
  if (optics.f_number == 0) return PointSpread(0, 0);
  const double px_per_m = 1e6 / scenario.rig.calibrated.pixel_um;
  const double focal_m = scenario.rig.calibrated.focal_mm * 1e-3;
  const double focus_m = optics.FocusOf(eye.index == 0 ? optics.left : optics.right);
  return PointSpread(DiffractionSigma_m(optics.f_number) * px_per_m,
                     DefocusDiameter_m(focal_m, optics.f_number, focus_m, distance_m) * px_per_m);
}

void PlaceRays(const Scenario& scenario, const RadianceMap& map, EyeView* eye) {
  const auto [width_px, height_px] = scenario.rig.calibrated.image;
  if (!eye->rays) {
    eye->rays.emplace(eye->camera, width_px, height_px);
    eye->shading = ShadingOf(*eye->rays, scenario.optics);
    eye->background_spread = SpreadAt(scenario, std::numeric_limits<double>::infinity(), *eye);
  }
  eye->warps.clear();
  for (const std::vector<Eigen::Matrix3d>& R_WC : eye->R_WC_background) {
    eye->warps.push_back(
        MakeWarpGrid(*eye->rays, R_WC, map, eye->observer->chart, eye->observer->u_near));
    eye->warps.back().share = eye->plan.background[eye->warps.size() - 1].share;
  }
}

}  // namespace windhover
