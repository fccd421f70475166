#include "render/stereo_renderer.h"

#include <algorithm>

#include "render/annotator.h"
#include "render/parallel_for.h"

namespace windhover {
namespace {

// Parts that an image is divided into for several threads.
constexpr int kBands = 16;

int FirstRowOf(int band, int height_px) { return band * height_px / kBands; }

// Mesa rasterises for one thread at a time: the others can draw the surroundings meanwhile.
bool DrawsOneAtATime(const Scenario& scenario) {
  return scenario.render.rasteriser == Rasteriser::kOsMesa;
}

bool IsInImage(const target_view_t& view) { return view.visible.w_px > 0 && view.visible.h_px > 0; }

}  // namespace

StereoRenderer::StereoRenderer(const Scenario& scenario, const std::vector<int>& observers,
                               int threads, const GivenShapes& given)
    : scenario_(scenario),
      threads_(std::max(threads, 1)),
      is_spread_(scenario.optics.f_number != 0),
      keeps_surroundings_(is_spread_ || (threads_ > 1 && DrawsOneAtATime(scenario))),
      geometry_(scenario, observers, given),
      environment_(MakeEnvironment(scenario.environment)),
      light_(scenario.environment, *environment_),
      haze_(scenario.environment.visibility_m),
      map_(*environment_, scenario.rig.calibrated.FocalPx()),
      sensor_(scenario.sensor),
      passes_(static_cast<std::size_t>(threads_)) {
  for (std::size_t i = 0; i < geometry_.Observers().size(); ++i) {
    views_.push_back(std::make_unique<StereoView>(geometry_.Observers()[i], i, scenario.exposure));
  }
}

StereoRenderer::~StereoRenderer() = default;

void StereoRenderer::ShadeTargets(const world_truth_t& world, StereoView* observer) const {
  observer->shaded.assign(observer->far_to_near.size(), ShadedTarget{});
  for (std::size_t k = 0; k < observer->far_to_near.size(); ++k) {
    const std::size_t i = observer->far_to_near[k];
    const AircraftShape& shape = geometry_.ShapeOf(i);
    const target_annotation_t& target = observer->TargetAt(i);
    // Very near, the outline may be in part where no camera can project it.
    const bool may_be_seen =
        target.range_m < 3 * shape.radius_m || IsInImage(target.left) || IsInImage(target.right);
    if (!may_be_seen) continue;
    const PreparedModel& model = *shape.prepared;
    const DetailLevel& level = model.LevelFor(target.depth_m, scenario_.rig.calibrated.FocalPx());
    observer->shaded[k] = Shade(model, level, PoseAt(world.uavs[i], 0).linear(), light_);
    const Eigen::Vector3d sight_W = PoseAt(world.uavs[i], 0).translation() -
                                    PoseAt(world.uavs[observer->rig.position], 0).translation();
    const Eigen::Vector3f air = environment_->AirLight(sight_W.normalized().cast<float>());
    haze_.Veil(air, static_cast<float>(target.range_m), observer->shaded[k].body_light);
    haze_.Veil(air, static_cast<float>(target.range_m), observer->shaded[k].disc_light);
  }
}

void StereoRenderer::DrawTargets(const world_truth_t& world, EyeView* eye, TargetPass* pass) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  StereoView& observer = *eye->observer;
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
  if (!is_spread_) return;
  for (std::size_t k = 0; k < eye->layers.size(); ++k) {
    const double distance_m = observer.TargetAt(observer.far_to_near[k]).depth_m;
    eye->layers[k] = SpreadLayer(
        eye->layers[k], SpreadAt(scenario_, std::max(distance_m, 0.1), *eye), width_px, height_px);
  }
}

// Through OpenGL all eyes are one task: a second context would take 60 MiB and draw no sooner.
void StereoRenderer::DrawTask(const world_truth_t& world, int task, int worker) {
  const bool is_one = DrawsOneAtATime(scenario_);
  std::unique_ptr<TargetPass>& pass = passes_[is_one ? 0 : static_cast<std::size_t>(worker)];
  if (pass == nullptr) {
    pass = MakeTargetPass(scenario_.render.rasteriser, scenario_.exposure.max_blur_px);
  }
  if (!is_one) return DrawTargets(world, EyeOf(task), pass.get());
  for (int i = 0; i < CountEyes(); ++i) DrawTargets(world, EyeOf(i), pass.get());
}

void StereoRenderer::DrawParts(const world_truth_t& world) {
  const int n_draw = DrawsOneAtATime(scenario_) ? 1 : CountEyes();
  const int n_bands = keeps_surroundings_ ? CountEyes() * kBands : 0;
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const auto n_values =
      static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * 3;
  for (int i = 0; i < CountEyes() && keeps_surroundings_; ++i) EyeOf(i)->linear.resize(n_values);
  ParallelFor(n_draw + n_bands, threads_, [&](int task, int worker) {
    if (task < n_draw) return DrawTask(world, task, worker);
    KeepSurroundings(EyeOf((task - n_draw) / kBands), (task - n_draw) % kBands);
  });
}

void StereoRenderer::KeepSurroundings(EyeView* eye, int band) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const std::ptrdiff_t count = width_px * 3;
  // What is written beyond a row must not be the next band's.
  std::vector<std::uint16_t> row(static_cast<std::size_t>(count) + kRowMargin);
  for (int y = FirstRowOf(band, height_px); y < FirstRowOf(band + 1, height_px); ++y) {
    eye->background->Row(y, row.data());
    std::copy_n(row.data(), count, eye->linear.data() + y * count);
  }
}

// Needs all rows of the sharp image.
void StereoRenderer::SpreadSurroundings() {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  for (int i = 0; i < CountEyes(); ++i) {
    EyeView* eye = EyeOf(i);
    std::swap(eye->linear, eye->sharp);
    eye->linear.resize(eye->sharp.size());
  }
  ParallelFor(CountEyes() * kBands, threads_,
              [&, width = width_px, height = height_px](int task, int) {
                EyeView* eye = EyeOf(task / kBands);
                const int band = task % kBands;
                for (int y = FirstRowOf(band, height); y < FirstRowOf(band + 1, height); ++y) {
                  SpreadRow({eye->sharp.data(), width, height, 3}, *eye->background_spread, y,
                            eye->linear.data() + static_cast<std::ptrdiff_t>(y) * width * 3);
                }
              });
}

// Row by row, so that a row is still in the cache when its last step takes it up, and so are the
// surroundings, of which both eyes see nearly the same.
void StereoRenderer::FinishBand(int band, int tick, StereoView* view, RenderedPair* pair) const {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  const std::ptrdiff_t count = width_px * 3;
  std::vector<std::uint16_t> own_row(static_cast<std::size_t>(count) + kRowMargin);
  const std::array shots = {ShotOf(view->eyes[0], tick), ShotOf(view->eyes[1], tick)};
  for (int y = FirstRowOf(band, height_px); y < FirstRowOf(band + 1, height_px); ++y) {
    for (EyeView& eye : view->eyes) {
      std::uint16_t* row = keeps_surroundings_ ? eye.linear.data() + y * count : own_row.data();
      if (!keeps_surroundings_) eye.background->Row(y, row);
      ComposeRow(eye.layers, eye.shading, sensor_, shots[static_cast<std::size_t>(eye.index)], y,
                 row, eye.index == 0 ? &pair->left : &pair->right);
    }
  }
}

Shot StereoRenderer::ShotOf(const EyeView& eye, int tick) const {
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
    views_[i]->eyes[0].exposure.Observe(sensor_.MeanLight(pairs[i].left));
    views_[i]->eyes[1].exposure.Observe(sensor_.MeanLight(pairs[i].right));
  }
}

EyeView* StereoRenderer::EyeOf(int index) {
  return &views_[static_cast<std::size_t>(index / 2)]->eyes[static_cast<std::size_t>(index % 2)];
}

RgbImage StereoRenderer::NewImage() {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  if (spare_images_.empty()) return RgbImage(width_px, height_px);
  RgbImage image = std::move(spare_images_.back());
  spare_images_.pop_back();
  return image;
}

void StereoRenderer::Recycle(std::vector<std::uint8_t>&& pixels) {
  const auto [width_px, height_px] = scenario_.rig.calibrated.image;
  RgbImage image;
  image.width_px = width_px;
  image.height_px = height_px;
  image.pixels = std::move(pixels);
  const auto n = static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px) * 3;
  if (image.pixels.size() == n) spare_images_.push_back(std::move(image));
}

std::vector<RenderedPair> StereoRenderer::Render(const world_truth_t& world, int tick) {
  geometry_.CheckWorld(world);
  const int n_observers = static_cast<int>(views_.size());
  ParallelFor(n_observers, threads_, [&](int i, int) {
    PlanFrame(scenario_, geometry_, map_, world, views_[static_cast<std::size_t>(i)].get());
  });
  ParallelFor(CountEyes(), threads_, [&](int i, int) { PlaceRays(scenario_, map_, EyeOf(i)); });
  for (const auto& view : views_) view->CoverSurroundings(&map_, threads_);
  ParallelFor(n_observers, threads_,
              [&](int i, int) { ShadeTargets(world, views_[static_cast<std::size_t>(i)].get()); });
  DrawParts(world);
  if (is_spread_) SpreadSurroundings();
  std::vector<RenderedPair> pairs;
  for (const auto& view : views_) {
    pairs.push_back({NewImage(), NewImage(), view->annotation, view->eyes[0].setting.duration_s});
  }
  ParallelFor(n_observers * kBands, threads_, [&](int task, int) {
    const auto i = static_cast<std::size_t>(task / kBands);
    FinishBand(task % kBands, tick, views_[i].get(), &pairs[i]);
  });
  Adapt(pairs, tick);
  return pairs;
}

}  // namespace windhover
