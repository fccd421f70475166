#include "render/scene_geometry.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>

#include "render/aircraft_meshes.h"
#include "render/annotator.h"
#include "render/motion.h"
#include "render/prepared_model.h"

namespace windhover {
namespace {

// Made once a process where it is our own drawing: thousands of flights have the same.
std::shared_ptr<const AircraftShape> CommonShape(const Aircraft& aircraft) {
  if (aircraft.type == AircraftType::kMesh) return MakeShape(MakeAircraftModel(aircraft));
  static std::mutex mutex;
  static std::map<AircraftType, std::shared_ptr<const AircraftShape>> drawn;
  const std::scoped_lock lock(mutex);
  std::shared_ptr<const AircraftShape>& shape = drawn[aircraft.type];
  if (shape == nullptr) shape = MakeShape(MakeAircraftModel(aircraft));
  return shape;
}

}  // namespace

std::shared_ptr<const AircraftShape> MakeShape(AircraftModel model) {
  auto shape = std::make_shared<AircraftShape>();
  shape->radius_m = 0;
  std::vector<Eigen::Vector3f> points = model.body.positions;
  points.insert(points.end(), model.rotor_discs.positions.begin(),
                model.rotor_discs.positions.end());
  std::vector<Eigen::Vector3d> outline_B;
  for (const std::uint32_t i : ExtremeVertices(points)) {
    outline_B.push_back(points[i].cast<double>());
    shape->radius_m = std::max(shape->radius_m, outline_B.back().norm());
  }
  shape->outline = Outline(outline_B);
  shape->prepared = std::make_shared<const PreparedModel>(model, shape->radius_m);
  shape->model = std::move(model);
  return shape;
}

SceneGeometry::SceneGeometry(const Scenario& scenario, const std::vector<int>& observers,
                             const GivenShapes& given)
    : exposure_(scenario.exposure),
      seed_(scenario.random_seed),
      width_px_(scenario.rig.calibrated.image[0]),
      height_px_(scenario.rig.calibrated.image[1]) {
  for (const Aircraft& aircraft : scenario.aircraft) {
    const auto shape = given.find(ids_.size());
    ids_.push_back(aircraft.self.id);
    shapes_.push_back(shape == given.end() ? CommonShape(aircraft) : shape->second);
  }
  for (const int place : observers) {
    const auto position = static_cast<std::size_t>(place);
    const CalibratedRig& rig = scenario.rig.calibrated;
    const std::string name = fmt::format("uav{}", ids_[position]);
    observers_.push_back(
        {position, ids_[position], name, rig.X_BR(),
         RigMotion(WithOptics(rig.ToStereoRig(), scenario.optics, rig.focal_mm * 1e-3),
                   scenario.rig.misalignment, scenario.flex, scenario.vibration,
                   scenario.random_seed, name)});
  }
}

void SceneGeometry::CheckWorld(const world_truth_t& world) const {
  bool fits = world.uavs.size() == ids_.size();
  for (std::size_t i = 0; fits && i < ids_.size(); ++i) fits = world.uavs[i].id == ids_[i];
  if (!fits) throw std::runtime_error("UAV_TRUTH does not hold the aircraft of the scenario");
}

StereoShutterTimes SceneGeometry::ShutterOf(const world_truth_t& world, std::size_t observer,
                                            double left_duration_s, double right_duration_s) const {
  return ShutterTimesAt(exposure_, left_duration_s, right_duration_s, height_px_, seed_,
                        observers_[observer].name, world.utime);
}

annotation_t SceneGeometry::Annotate(const world_truth_t& world, std::size_t observer) const {
  const double nominal_s = exposure_.duration_ms * 1e-3;
  return Annotate(world, observer, ShutterOf(world, observer, nominal_s, nominal_s));
}

annotation_t SceneGeometry::Annotate(const world_truth_t& world, std::size_t observer,
                                     const StereoShutterTimes& shutter) const {
  const ObserverRig& rig = observers_[observer];
  const Eigen::Isometry3d X_RW = (PoseAt(world.uavs[rig.position], 0) * rig.X_BR).inverse();
  const StereoRowCameras cameras =
      CamerasByRows(world, rig.position, rig.X_BR, rig.motion, shutter, height_px_, 0);
  annotation_t annotation{};
  annotation.utime = world.utime;
  annotation.observer_id = rig.id;
  for (std::size_t i = 0; i < world.uavs.size(); ++i) {
    if (i == rig.position) continue;
    target_annotation_t target{};
    target.target_id = ids_[i];
    const Eigen::Vector3d p_RT_m = X_RW * PoseAt(world.uavs[i], 0).translation();
    Eigen::Map<Eigen::Vector3d>(target.p_RT_m) = p_RT_m;
    target.range_m = p_RT_m.norm();
    target.depth_m = p_RT_m.z();
    const Outline& outline = shapes_[i]->outline;
    target.left = ViewFromGeometry(outline, PosesOf(cameras.left, world.uavs[i]),
                                   cameras.left.camera, width_px_, height_px_);
    target.right = ViewFromGeometry(outline, PosesOf(cameras.right, world.uavs[i]),
                                    cameras.right.camera, width_px_, height_px_);
    annotation.targets.push_back(target);
  }
  annotation.n_targets = static_cast<std::int32_t>(annotation.targets.size());
  return annotation;
}

}  // namespace windhover
