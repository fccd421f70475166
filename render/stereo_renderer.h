#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include "common/image/rgb_image.h"
#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/background.h"
#include "render/environment.h"
#include "render/motion.h"
#include "render/point_spread.h"
#include "render/prepared_model.h"
#include "render/scene_geometry.h"
#include "render/sensor.h"
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
  StereoRenderer(const Scenario& scenario, const std::vector<int>& observers, int threads);
  ~StereoRenderer();

  /// Renders a pair for each observer, in their order. `world` holds every aircraft of the
  /// scenario, in its order. @throws std::runtime_error if it does not.
  std::vector<RenderedPair> Render(const world_truth_t& world, int tick);

 private:
  struct Observer;
  struct Eye;

  void PlanObserver(const world_truth_t& world, Observer* observer) const;
  void PlaceEyes(const world_truth_t& world, Observer* observer) const;
  void SortFarToNear(Observer* observer) const;
  void PrepareEye(Eye* eye) const;
  void CoverViews(Observer* observer);
  void ShadeTargets(const world_truth_t& world, Observer* observer) const;
  void DrawTargets(const world_truth_t& world, Eye* eye, TargetPass* pass) const;
  void PlaceBackgrounds(Eye* eye) const;
  void SpreadBackgrounds();
  void Adapt(const std::vector<RenderedPair>& pairs, int tick);
  void DrawParts(const world_truth_t& world);
  PointSpread SpreadAt(double distance_m, const Eye& eye) const;
  Shot ShotOf(const Eye& eye, int tick) const;
  Eye* EyeOf(int index);  ///< 2 · observer, and one more for the right.

  const Scenario scenario_;
  const int threads_;
  SceneGeometry geometry_;
  std::unique_ptr<Environment> environment_;
  SkyLight light_;
  RadianceMap map_;
  Sensor sensor_;
  std::map<const AircraftShape*, PreparedModel> models_;
  std::vector<std::unique_ptr<Observer>> observers_;
  std::vector<std::unique_ptr<TargetPass>> passes_;  ///< One a thread, made at first use.
};

}  // namespace windhover
