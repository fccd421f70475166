#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "lcmtypes/annotation_t.hpp"
#include "lcmtypes/world_truth_t.hpp"
#include "render/mesh.h"
#include "render/outline.h"
#include "rig/rig_motion.h"
#include "scenarios/scenario.h"

namespace windhover {

class PreparedModel;

/// What an aircraft looks like, and the points that can bound its silhouette.
struct AircraftShape {
  AircraftModel model;
  Outline outline;                                ///< Of body and propellers.
  double radius_m;                                ///< Of a ball about B's origin that holds it all.
  std::shared_ptr<const PreparedModel> prepared;  ///< For all who draw it.
};

std::shared_ptr<const AircraftShape> MakeShape(AircraftModel model);

/// What aircraft look like in place of what the scenario says, by position in it: of types that are
/// no scenario's.
using GivenShapes = std::map<std::size_t, std::shared_ptr<const AircraftShape>>;

/// The true rig of one aircraft.
struct ObserverRig {
  std::size_t position;  ///< In scenario.aircraft.
  int id;
  std::string name;  ///< "uav0": of its random streams.
  Eigen::Isometry3d X_BR;
  RigMotion motion;
};

/// Everything about a scenario's targets that needs no pixels.
class SceneGeometry {
 public:
  /// `observers`: positions in scenario.aircraft of the aircraft whose rigs are of interest.
  /// @throws ConfigError if a mesh or a vibration file cannot be used.
  SceneGeometry(const Scenario& scenario, const std::vector<int>& observers,
                const GivenShapes& given = {});

  const std::vector<ObserverRig>& Observers() const { return observers_; }
  const AircraftShape& ShapeOf(std::size_t position) const { return *shapes_[position]; }

  /// @throws std::runtime_error if `world` does not hold the scenario's aircraft in its order.
  void CheckWorld(const world_truth_t& world) const;

  /// When the cameras of `Observers()[observer]` take the frame of the world's utime.
  StereoShutterTimes ShutterOf(const world_truth_t& world, std::size_t observer,
                               double left_duration_s, double right_duration_s) const;

  /// The truth about every other aircraft at the world's utime, and the boxes as the cameras of
  /// `Observers()[observer]` see them when `shutter` exposes them, as if nothing hid anything
  /// (ViewFromGeometry).
  annotation_t Annotate(const world_truth_t& world, std::size_t observer,
                        const StereoShutterTimes& shutter) const;
  /// The same for exposures of the nominal duration.
  annotation_t Annotate(const world_truth_t& world, std::size_t observer) const;

 private:
  ExposureConfig exposure_;
  std::uint64_t seed_;
  std::vector<int> ids_;
  int width_px_, height_px_;
  std::vector<std::shared_ptr<const AircraftShape>> shapes_;  ///< One an aircraft.
  std::vector<ObserverRig> observers_;
};

}  // namespace windhover
