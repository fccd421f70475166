#pragma once

#include <memory>
#include <vector>

#include "common/image/rgb_image.h"
#include "lcmtypes/annotation_t.hpp"
#include "render/environment.h"
#include "render/haze.h"
#include "render/prepared_model.h"
#include "render/sensor.h"
#include "render/stereo_view.h"
#include "render/target_pass.h"
#include "scenarios/scenario.h"

namespace windhover {

/// A stereo pair and the truth about it.
struct RenderedPair {
  RgbImage left, right;
  annotation_t annotation;
  double exposure_s;  ///< Of the left camera.
};

/// What the true stereo rigs of a scenario's aircraft see.
///
/// Targets hide each other by distance: the nearer aircraft as a whole is in front.
///
/// A frame is a function of scenario, world, tick and observer: the number of threads does not
/// change a bit of it, nor do earlier frames unless exposure is automatic.
class StereoRenderer {
 public:
  /// `observers`: positions in scenario.aircraft of the aircraft whose rigs will be rendered.
  /// @throws ConfigError if a mesh, an environment's image or a vibration file cannot be used.
  StereoRenderer(const Scenario& scenario, const std::vector<int>& observers, int threads,
                 const GivenShapes& given = {});
  ~StereoRenderer();

  /// Renders a pair for each observer, in their order. `world` holds every aircraft of the
  /// scenario, in its order. @throws std::runtime_error if it does not.
  std::vector<RenderedPair> Render(const world_truth_t& world, int tick);

  /// Takes the memory of an image that is no longer needed, for a later one.
  void Recycle(std::vector<std::uint8_t>&& pixels);

 private:
  void ShadeTargets(const world_truth_t& world, StereoView* view) const;
  void DrawTargets(const world_truth_t& world, EyeView* eye, TargetPass* pass) const;
  void DrawTask(const world_truth_t& world, int task, int worker);
  void DrawParts(const world_truth_t& world);
  void KeepSurroundings(EyeView* eye, int band) const;
  void SpreadSurroundings();
  void FinishBand(int band, int tick, StereoView* view, RenderedPair* pair) const;
  RgbImage NewImage();  ///< Holds anything.
  void Adapt(const std::vector<RenderedPair>& pairs, int tick);
  Shot ShotOf(const EyeView& eye, int tick) const;
  EyeView* EyeOf(int index);  ///< 2 · observer, and one more for the right.
  int CountEyes() const { return 2 * static_cast<int>(views_.size()); }

  const Scenario scenario_;
  const int threads_;
  const bool is_spread_;           ///< Lenses blur: an image needs all of its surroundings first.
  const bool keeps_surroundings_;  ///< They are drawn whole before the rest of an image.
  SceneGeometry geometry_;
  std::unique_ptr<Environment> environment_;
  SkyLight light_;
  Haze haze_;
  RadianceMap map_;
  Sensor sensor_;
  std::vector<std::unique_ptr<StereoView>> views_;
  std::vector<std::unique_ptr<TargetPass>>
      passes_;  ///< One a thread (OSMesa: one), made at first use.
  std::vector<RgbImage> spare_images_;
};

}  // namespace windhover
