#include "render/stereo_renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/annotator.h"
#include "render/auto_exposure.h"
#include "render/eye_image.h"
#include "render/parallel_for.h"

namespace windhover {
namespace {

// Parts that an image is divided into for several threads.
constexpr int kBands = 8;

RowBand BandOf(int band, int height_px) {
  return {band * height_px / kBands, (band + 1) * height_px / kBands};
}

bool IsInImage(const target_view_t& view) { return view.visible.w_px > 0 && view.visible.h_px > 0; }

}  // namespace

/// One camera of one observer during one frame.
struct StereoRenderer::Eye {
  explicit Eye(const ExposureConfig& config)
      : exposure(config.auto_exposure, config.duration_ms * 1e-3) {}

  int index = 0;  ///< 0 left, 1 right.
  Observer* observer = nullptr;
  std::optional<RayGrid> rays;
  AnyCamera camera;
  AutoExposure exposure;
  ExposureSetting setting{};
  ExposurePlan plan;
  std::vector<RowCameras> cameras;                            ///< One a sub-exposure.
  std::vector<std::vector<Eigen::Matrix3d>> R_WC_background;  ///< Likewise, of the background.
  std::optional<PointSpread> background_spread;
  std::vector<std::uint16_t> shading;
  std::vector<WarpGrid> warps;
  std::vector<BackgroundShare> backgrounds;
  std::vector<std::uint16_t> linear;  ///< Linear light of the image in the making.
  std::vector<std::uint16_t> sharp;   ///< The surroundings as a perfect lens shows them.
  std::vector<TargetLayer> layers;    ///< Far to near.
};

struct StereoRenderer::Observer {
  Observer(const ObserverRig& observer_rig, std::size_t observer_index,
           const ExposureConfig& exposure)
      : rig(observer_rig), index(observer_index), eyes{Eye(exposure), Eye(exposure)} {
    eyes[1].index = 1;
    for (Eye& eye : eyes) eye.observer = this;
  }

  /// The annotation's entry of the aircraft at `position` of the scenario.
  target_annotation_t& TargetAt(std::size_t position) {
    return annotation.targets[position - (position > rig.position ? 1 : 0)];
  }
  target_view_t& ViewOf(std::size_t position, const Eye& eye) {
    return eye.index == 0 ? TargetAt(position).left : TargetAt(position).right;
  }

  const ObserverRig& rig;
  std::size_t index;
  std::array<Eye, 2> eyes;
  MapWindow window;

  // Of the frame being rendered.
  StereoShutterTimes shutter;
  Chart chart{};
  double u_near = 0;
  annotation_t annotation{};
  std::vector<std::size_t> far_to_near;  ///< Positions of the other aircraft.
  std::vector<ShadedTarget> shaded;      ///< In that order; without a model if out of view.
};

StereoRenderer::StereoRenderer(const Scenario& scenario, const std::vector<int>& observers,
                               int threads)
    : scenario_(scenario),
      threads_(std::max(threads, 1)),
      geometry_(scenario, observers),
      environment_(MakeEnvironment(scenario.environment)),
      light_(scenario.environment, *environment_),
      map_(*environment_, scenario.rig.calibrated.FocalPx()),
      sensor_(scenario.sensor),
      passes_(static_cast<std::size_t>(threads_)) {
  for (std::size_t i = 0; i < scenario.aircraft.size(); ++i) {
    const AircraftShape& shape = geometry_.ShapeOf(i);
    models_.try_emplace(&shape, shape.model, shape.radius_m);
  }
  for (std::size_t i = 0; i < geometry_.Observers().size(); ++i) {
    observers_.push_back(
        std::make_unique<Observer>(geometry_.Observers()[i], i, scenario.exposure));
  }
}

StereoRenderer::~StereoRenderer() = default;

// Everything of a frame but its pixels.
void StereoRenderer::PlanObserver(const world_truth_t& world, Observer* observer) const {
  const ObserverRig& rig = observer->rig;
  for (Eye& eye : observer->eyes) {
    const bool is_led = scenario_.exposure.auto_exposure.mode == AutoExposureMode::kShared;
    eye.setting = observer->eyes[is_led ? 0 : eye.index].exposure.Setting();
  }
  observer->shutter =
      geometry_.ShutterOf(world, observer->index, observer->eyes[0].setting.duration_s,
                          observer->eyes[1].setting.duration_s);
  observer->annotation = geometry_.Annotate(world, observer->index, observer->shutter);
  const Eigen::Vector3d axis_W = (PoseAt(world.uavs[rig.position], 0) * rig.X_BR).linear().col(2);
  observer->chart = ChartFor(axis_W);
  observer->u_near = map_.PlaceOf(axis_W, observer->chart).x();
  PlaceEyes(world, observer);
  SortFarToNear(observer);
}

// Where the cameras are during their sub-exposures, which are the same for both where they expose
// equally long.
void StereoRenderer::PlaceEyes(const world_truth_t& world, Observer* observer) const {
  const ObserverRig& rig = observer->rig;
  const double focal_px = scenario_.rig.calibrated.FocalPx();
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  auto& eyes = observer->eyes;
  const bool is_alike = eyes[0].setting.duration_s == eyes[1].setting.duration_s;
  for (Eye& eye : eyes) {
    eye.cameras.clear();
    eye.R_WC_background.clear();
    eye.plan = is_alike && eye.index == 1 ? eyes[0].plan
                                          : PlanExposure(scenario_.exposure, eye.setting.duration_s,
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
  for (Eye& eye : eyes) eye.camera = eye.cameras.front().camera;
}

void StereoRenderer::SortFarToNear(Observer* observer) const {
  const std::size_t own = observer->rig.position;
  observer->far_to_near.clear();
  for (std::size_t i = 0; i < scenario_.aircraft.size(); ++i) {
    if (i != own) observer->far_to_near.push_back(i);
  }
  std::stable_sort(observer->far_to_near.begin(), observer->far_to_near.end(),
                   [observer](std::size_t a, std::size_t b) {
                     return observer->TargetAt(a).range_m > observer->TargetAt(b).range_m;
                   });
}

void StereoRenderer::PrepareEye(Eye* eye) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  if (!eye->rays) {
    eye->rays.emplace(eye->camera, width_px, height_px);
    eye->shading = ShadingOf(*eye->rays, scenario_.optics);
    eye->background_spread = SpreadAt(std::numeric_limits<double>::infinity(), *eye);
  }
  eye->warps.clear();
  for (const std::vector<Eigen::Matrix3d>& R_WC : eye->R_WC_background) {
    eye->warps.push_back(
        MakeWarpGrid(*eye->rays, R_WC, map_, eye->observer->chart, eye->observer->u_near));
  }
}

void StereoRenderer::CoverViews(Observer* observer) {
  double u_min = 1e18, u_max = -1e18, v_min = 1e18, v_max = -1e18;
  for (const Eye& eye : observer->eyes) {
    for (const WarpGrid& warp : eye.warps) {
      u_min = std::min(u_min, warp.u_min);
      u_max = std::max(u_max, warp.u_max);
      v_min = std::min(v_min, warp.v_min);
      v_max = std::max(v_max, warp.v_max);
    }
  }
  const auto low = [](double v) { return static_cast<int>(std::floor(v)) - 1; };
  const auto high = [](double v) { return static_cast<int>(std::ceil(v)) + 2; };
  map_.Cover(observer->chart, low(u_min), high(u_max), low(v_min), high(v_max), threads_,
             &observer->window);
}

void StereoRenderer::ShadeTargets(const world_truth_t& world, Observer* observer) const {
  observer->shaded.assign(observer->far_to_near.size(), ShadedTarget{});
  for (std::size_t k = 0; k < observer->far_to_near.size(); ++k) {
    const std::size_t i = observer->far_to_near[k];
    const AircraftShape& shape = geometry_.ShapeOf(i);
    const target_annotation_t& target = observer->TargetAt(i);
    // Very near, the outline may be in part where no camera can project it.
    const bool may_be_seen =
        target.range_m < 3 * shape.radius_m || IsInImage(target.left) || IsInImage(target.right);
    if (!may_be_seen) continue;
    const PreparedModel& model = models_.at(&shape);
    const DetailLevel& level = model.LevelFor(target.depth_m, scenario_.rig.calibrated.FocalPx());
    observer->shaded[k] = Shade(model, level, PoseAt(world.uavs[i], 0).linear(), light_);
  }
}

void StereoRenderer::DrawTargets(const world_truth_t& world, Eye* eye, TargetPass* pass) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  Observer& observer = *eye->observer;
  eye->layers.assign(observer.shaded.size(), TargetLayer{});
  for (std::size_t k = 0; k < eye->layers.size(); ++k) {
    if (observer.shaded[k].model == nullptr) continue;
    const uav_truth_t& truth = world.uavs[observer.far_to_near[k]];
    std::vector<RowPoses> X_CB;
    for (const RowCameras& cameras : eye->cameras) X_CB.push_back(PosesOf(cameras, truth));
    const target_view_t& view = observer.ViewOf(observer.far_to_near[k], *eye);
    const ShutterTimes& shutter = eye->index == 0 ? observer.shutter.left : observer.shutter.right;
    const RotorTurning rotors =
        TurningOf(truth, shutter.RowMiddle_s(view.centre_px[1]), shutter.duration_s);
    eye->layers[k] = pass->Draw(observer.shaded[k], eye->camera, width_px, height_px,
                                std::span<const RowPoses>(X_CB), rotors);
  }
  for (std::size_t k = 0; k < eye->layers.size(); ++k) {
    target_view_t& view = observer.ViewOf(observer.far_to_near[k], *eye);
    if (view.in_front != 0) SetVisibility(eye->layers, k, &view);
  }
  if (scenario_.optics.f_number == 0) return;
  for (std::size_t k = 0; k < eye->layers.size(); ++k) {
    const double distance_m = observer.TargetAt(observer.far_to_near[k]).depth_m;
    eye->layers[k] =
        SpreadLayer(eye->layers[k], SpreadAt(std::max(distance_m, 0.1), *eye), width_px, height_px);
  }
}

void StereoRenderer::PlaceBackgrounds(Eye* eye) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  eye->backgrounds.clear();
  for (std::size_t n = 0; n < eye->warps.size(); ++n) {
    eye->backgrounds.push_back(
        {BackgroundWarp(*eye->rays, eye->warps[n], map_, eye->observer->window),
         eye->plan.background[n].share});
  }
  eye->linear.resize(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * 3);
}

// OpenGL first: Mesa draws for one thread at a time, so both eyes of an observer are one task, and
// the other threads fill the surroundings meanwhile.
void StereoRenderer::DrawParts(const world_truth_t& world) {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const int n_observers = static_cast<int>(observers_.size());
  const int n_bands = 2 * n_observers * kBands;
  ParallelFor(
      n_observers + n_bands, threads_,
      [&, width = width_px, height = height_px](int task, int worker) {
        if (task < n_observers) {
          std::unique_ptr<TargetPass>& pass = passes_[static_cast<std::size_t>(worker)];
          if (pass == nullptr) {
            pass =
                std::make_unique<TargetPass>(MakeOsMesaContext(), scenario_.exposure.max_blur_px);
          }
          for (Eye& eye : observers_[static_cast<std::size_t>(task)]->eyes) {
            DrawTargets(world, &eye, pass.get());
          }
          return;
        }
        const int band = task - n_observers;
        Eye* eye = EyeOf(band / kBands);
        FillBackground(eye->backgrounds, BandOf(band % kBands, height), width, eye->linear.data());
      });
}

// What a camera makes of points at a distance.
PointSpread StereoRenderer::SpreadAt(double distance_m, const Eye& eye) const {
  const OpticsConfig& optics = scenario_.optics;
  if (optics.f_number == 0) return PointSpread(0, 0);
  const double px_per_m = 1e6 / scenario_.rig.calibrated.pixel_um;
  const double focal_m = scenario_.rig.calibrated.focal_mm * 1e-3;
  const double focus_m = optics.FocusOf(eye.index == 0 ? optics.left : optics.right);
  return PointSpread(DiffractionSigma_m(optics.f_number) * px_per_m,
                     DefocusDiameter_m(focal_m, optics.f_number, focus_m, distance_m) * px_per_m);
}

// Needs all rows of the sharp image.
void StereoRenderer::SpreadBackgrounds() {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const int n_eyes = 2 * static_cast<int>(observers_.size());
  if (scenario_.optics.f_number == 0) return;
  for (int i = 0; i < n_eyes; ++i) {
    Eye* eye = EyeOf(i);
    std::swap(eye->linear, eye->sharp);
    eye->linear.resize(eye->sharp.size());
  }
  ParallelFor(n_eyes * kBands, threads_, [&, width = width_px, height = height_px](int task, int) {
    Eye* eye = EyeOf(task / kBands);
    const RowBand band = BandOf(task % kBands, height);
    for (int y = band.y0; y < band.y1; ++y) {
      SpreadRow({eye->sharp.data(), width, height, 3}, *eye->background_spread, y,
                eye->linear.data() + static_cast<std::ptrdiff_t>(y) * width * 3);
    }
  });
}

Shot StereoRenderer::ShotOf(const Eye& eye, int tick) const {
  const double nominal_s = scenario_.exposure.duration_ms * 1e-3;
  return {.key = {scenario_.random_seed, eye.observer->rig.id, eye.index, tick},
          .exposure_s = eye.setting.duration_s,
          .brightness = eye.setting.duration_s / nominal_s,
          .gain = eye.setting.gain};
}

// Cameras go by the images that they gave; a rehearsal (tick -1) leaves no trace.
void StereoRenderer::Adapt(const std::vector<RenderedPair>& pairs, int tick) {
  if (tick < 0 || scenario_.exposure.auto_exposure.mode == AutoExposureMode::kOff) return;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    observers_[i]->eyes[0].exposure.Observe(sensor_.MeanLight(pairs[i].left));
    observers_[i]->eyes[1].exposure.Observe(sensor_.MeanLight(pairs[i].right));
  }
}

StereoRenderer::Eye* StereoRenderer::EyeOf(int index) {
  return &observers_[static_cast<std::size_t>(index / 2)]
              ->eyes[static_cast<std::size_t>(index % 2)];
}

std::vector<RenderedPair> StereoRenderer::Render(const world_truth_t& world, int tick) {
  geometry_.CheckWorld(world);
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const int n_observers = static_cast<int>(observers_.size());
  ParallelFor(n_observers, threads_,
              [&](int i, int) { PlanObserver(world, EyeOf(2 * i)->observer); });
  ParallelFor(2 * n_observers, threads_, [&](int i, int) { PrepareEye(EyeOf(i)); });
  for (const auto& observer : observers_) CoverViews(observer.get());
  for (int i = 0; i < 2 * n_observers; ++i) PlaceBackgrounds(EyeOf(i));
  ParallelFor(n_observers, threads_,
              [&](int i, int) { ShadeTargets(world, EyeOf(2 * i)->observer); });
  DrawParts(world);
  SpreadBackgrounds();
  std::vector<RenderedPair> pairs;
  for (const auto& observer : observers_) {
    pairs.push_back({RgbImage(width_px, height_px), RgbImage(width_px, height_px),
                     observer->annotation, observer->eyes[0].setting.duration_s});
  }
  ParallelFor(2 * n_observers * kBands, threads_, [&, height = height_px](int task, int) {
    Eye* eye = EyeOf(task / kBands);
    RenderedPair& pair = pairs[static_cast<std::size_t>(task / kBands / 2)];
    ComposeRows(eye->layers, eye->shading, sensor_, ShotOf(*eye, tick),
                BandOf(task % kBands, height), eye->linear.data(),
                eye->index == 0 ? &pair.left : &pair.right);
  });
  Adapt(pairs, tick);
  return pairs;
}

}  // namespace windhover
