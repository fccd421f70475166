#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/config/fields.h"
#include "rig/box_noise.h"
#include "rig/exposure.h"
#include "rig/flex.h"
#include "rig/misalignment.h"
#include "rig/optics.h"
#include "rig/vibration.h"
#include "scenarios/aircraft_config.h"
#include "scenarios/dataset_config.h"
#include "scenarios/flight_config.h"
#include "scenarios/randomized_key.h"
#include "scenarios/render_config.h"
#include "scenarios/sensor_config.h"
#include "scenarios/uwb_config.h"

namespace windhover {

struct RigConfig {
  CalibratedRig calibrated;
  Misalignment misalignment;

  template <typename Visitor>
  void Fields(Visitor& v) {
    calibrated.Fields(v);
    v.Section("misalignment", misalignment, "how the true rig differs from the calibrated one");
  }
};

/// A recorded or prescribed path: TUM (t x y z qx qy qz qw) or EuRoC (CSV, ns, qw first).
struct TrajectoryConfig {
  InputFile file;
  double scale = 1;
  std::array<double, 3> offset_m = {0, 0, 0};
  double yaw_deg = 0;
  double start_s = 0;
  double speed = 1;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("file", file, MayBeEmpty{}, "path in TUM or EuRoC format");
    v.Field("scale", scale, InRange{1e-6, 1e6}, "factor on positions");
    v.Field("offset_m", offset_m, InRange{-1e6, 1e6}, "added after scaling and turning");
    v.Field("yaw_deg", yaw_deg, InRange{-360, 360}, "turn of the whole path about W's z");
    v.Field("start_s", start_s, InRange{0, 1e9}, "where in the recording the run starts");
    v.Field("speed", speed, InRange{1e-3, 1e3}, "recorded seconds per simulated second");
  }
};

struct Waypoint {
  double time_s = 0;
  std::array<double, 3> position_m = {0, 0, 0};
  double yaw_deg = 0;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("time_s", time_s, InRange{0, 1e6}, "when to be there");
    v.Field("position_m", position_m, InRange{-1e5, 1e5}, "east, north, up");
    v.Field("yaw_deg", yaw_deg, InRange{-360, 360}, "heading, 0 is east");
  }
};

/// A mesh that is not ours: any file that assimp reads.
struct MeshConfig {
  InputFile file;
  double scale = 1;
  std::array<double, 3> rotation_deg = {0, 0, 0};
  std::array<double, 3> offset_m = {0, 0, 0};

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("file", file, MayBeEmpty{}, "mesh file");
    v.Field("scale", scale, InRange{1e-6, 1e6}, "factor to metres");
    v.Field("rotation_deg", rotation_deg, InRange{-360, 360},
            "roll, pitch, yaw (applied in this order) to forward-left-up");
    v.Field("offset_m", offset_m, InRange{-1e3, 1e3},
            "added after turning; the body frame's origin is the target's centre");
  }
};

enum class AircraftType { kM200Orange, kM200Black, kP600, kMesh };
template <>
inline constexpr EnumNames<AircraftType> kEnumNames<AircraftType>{
    {AircraftType::kM200Orange, "m200_orange"},
    {AircraftType::kM200Black, "m200_black"},
    {AircraftType::kP600, "p600"},
    {AircraftType::kMesh, "mesh"}};

struct Aircraft {
  AircraftSelf self;  ///< id, carries_rig, controller, follow, goal.
  AircraftType type = AircraftType::kM200Orange;
  MeshConfig mesh;
  std::array<double, 3> position_m = {0, 0, 0};
  double yaw_deg = 0;
  Dynamics dynamics = Dynamics::kKinematic;
  std::array<double, 3> cg_offset_m = {0, 0, 0};
  std::array<double, 3> uwb_antenna_m = {0, 0, 0};
  TrajectoryConfig trajectory;
  std::vector<Waypoint> waypoints;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("id", self.id, InRange{0, 999}, "number of the aircraft, used in channel names");
    v.Field("type", type, AnyEnum{}, "what it looks like");
    v.Section("mesh", mesh, "type: mesh");
    v.Field("carries_rig", self.carries_rig, AnyBool{}, "whether it carries the stereo rig");
    v.Field("controller", self.controller, AnyEnum{}, "who moves it");
    v.Field("position_m", position_m, InRange{-1e5, 1e5}, "start: east, north, up");
    v.Field("yaw_deg", yaw_deg, InRange{-360, 360}, "start: heading, 0 is east");
    v.Field("dynamics", dynamics, AnyEnum{}, "whether forces move it");
    v.Field("cg_offset_m", cg_offset_m, InRange{-0.05, 0.05},
            "rigid_body: its centre of mass in the body frame");
    v.Field("uwb_antenna_m", uwb_antenna_m, InRange{-5, 5},
            "where its antenna is, in the body frame and from uwb.antenna_m");
    v.Section("trajectory", trajectory, "controller: trajectory");
    v.List("waypoints", waypoints, "controller: waypoints, in order of time");
    v.Section("follow", self.follow, "controller: follow");
    v.Section("goal", self.goal, "controller: swarm");
  }
};

struct NavConfig {
  double position_sigma_m = 0.02;
  double velocity_sigma_mps = 0.02;
  double attitude_sigma_deg = 0.1;
  double imu_rate_hz = 200;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("position_sigma_m", position_sigma_m, InRange{0, 100}, "noise of the own position");
    v.Field("velocity_sigma_mps", velocity_sigma_mps, InRange{0, 100}, "noise of the own velocity");
    v.Field("attitude_sigma_deg", attitude_sigma_deg, InRange{0, 45}, "noise of the own attitude");
    v.Field("imu_rate_hz", imu_rate_hz, InRange{0, 10000}, "IMU samples per second; 0: no IMU");
  }
};

enum class ScoreReference { kRange, kDepth, kUwb };
template <>
inline constexpr EnumNames<ScoreReference> kEnumNames<ScoreReference>{
    {ScoreReference::kRange, "range"},
    {ScoreReference::kDepth, "depth"},
    {ScoreReference::kUwb, "uwb"}};

struct ScoreConfig {
  ScoreReference reference = ScoreReference::kRange;
  double near_miss_m = 1.5;
  double collision_m = 0.6;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("reference", reference, AnyEnum{}, "the distance that estimates are held against");
    v.Field("near_miss_m", near_miss_m, InRange{0, 100}, "separation that counts as a near miss");
    v.Field("collision_m", collision_m, InRange{0, 100}, "separation that counts as a collision");
  }
};

/// One gate: a metric of score.json, by path, and what it must be.
struct Expectation {
  std::string metric;
  double max = kUnset, min = kUnset, upper95 = kUnset, lower95 = kUnset;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("metric", metric, NotEmpty{}, "path in score.json: methods.baseline.abs_rel_all");
    v.Field("max", max, Optional{}, "largest value that passes");
    v.Field("min", min, Optional{}, "smallest value that passes");
    v.Field("upper95", upper95, Optional{}, "the 95 % interval must end below this");
    v.Field("lower95", lower95, Optional{}, "the 95 % interval must begin above this");
  }
};

/// How a run is spread over processes. Has no influence on its results, nor on its log.
struct ExecutionConfig {
  int render_processes = 1;
  int estimator_processes = 1;
  int swarm_processes = 1;
  double deadline_s = 30;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("render_processes", render_processes, InRange{1, 64}, "render processes to start");
    v.Field("estimator_processes", estimator_processes, InRange{1, 64},
            "estimator processes to start");
    v.Field("swarm_processes", swarm_processes, InRange{1, 64}, "swarm processes to start");
    v.Field("deadline_s", deadline_s, InRange{0.1, 3600},
            "wall-clock time a tick may take before the run is INVALID");
  }
};

/// One run of the simulator, as written in scenarios/*.yaml (after `extends` and --set).
struct Scenario {
  std::string description;
  std::uint64_t random_seed = 1;
  double duration_s = 20;
  double frame_rate_hz = 10;
  Observe observe = Observe::kGeometric;
  RigConfig rig;
  FlexConfig flex;
  VibrationConfig vibration;
  OpticsConfig optics;
  ExposureConfig exposure;
  SensorConfig sensor;
  NavConfig nav;
  UwbConfig uwb;
  WindConfig wind;
  std::vector<Aircraft> aircraft;  ///< Sorted by id, at least one.
  EnvironmentConfig environment;
  RenderConfig render;
  GeometricConfig geometric;
  EstimatorConfig estimator;
  SwarmConfig swarm;
  ScoreConfig score;
  DatasetConfig dataset;
  std::vector<RandomizedKey> randomize;
  std::vector<Expectation> expect;
  ExecutionConfig execution;

  template <typename Visitor>
  void Fields(Visitor& v) {
    v.Field("description", description, NotEmpty{}, "one sentence: what this scenario is for");
    v.Field("random_seed", random_seed, InRange{0, 9e15}, "seed of every random stream");
    v.Field("duration_s", duration_s, InRange{1e-3, 1e5}, "simulated time of the run");
    v.Field("frame_rate_hz", frame_rate_hz, InRange{0.1, 1000}, "stereo frames per second");
    v.Field("observe", observe, AnyEnum{}, "what the estimator gets of each frame");
    v.Section("rig", rig, "the stereo rig");
    v.Section("flex", flex, "bending of the bar between the cameras");
    v.Section("vibration", vibration, "vibration at the root of the bar");
    v.Section("optics", optics, "lenses beyond their calibration: focus, temperature, blur");
    v.Section("exposure", exposure, "shutter of both cameras");
    v.Section("sensor", sensor, "from light to bytes");
    v.Section("nav", nav, "what an aircraft's own navigation reports");
    v.Section("uwb", uwb, "UWB ranging between aircraft");
    v.Section("wind", wind, "moving air; acts on aircraft of dynamics rigid_body");
    v.List("aircraft", aircraft, "every aircraft");
    v.Section("environment", environment, "surroundings and light");
    v.Section("render", render, "how images are made");
    v.Section("geometric", geometric, "boxes of observe: geometric");
    v.Section("estimator", estimator, "detection and distance estimation");
    v.Section("swarm", swarm, "how aircraft with controller swarm fly");
    v.Section("score", score, "how the run is scored");
    v.Section("dataset", dataset, "flights that make a data set");
    v.List("randomize", randomize, "keys that every random_seed draws anew");
    v.List("expect", expect, "gates: the run passes when all hold");
    v.Section("execution", execution, "how the run is spread over processes");
  }

  AircraftConfig ForAircraft() const;
};

/// Reads a scenario file, follows `extends`, applies `overrides` ("a.b=c"), checks it all, draws
/// what `randomize` lists (scenarios/randomize.h).
/// @throws ConfigError listing every problem, each as file:line:col: key.path: …, or else what is
/// wrong inside the file of the vibration, each as file:line: ….
Scenario LoadScenario(const std::filesystem::path& file,
                      const std::vector<std::string>& overrides = {});

/// The same with nothing drawn (and only what `overrides` do not hold to be drawn): as the base of
/// a data set, every flight of which draws anew.
Scenario LoadUndrawnScenario(const std::filesystem::path& file,
                             const std::vector<std::string>& overrides = {});

/// Reads what ResolvedYaml wrote, such as the header of a log, where the input files need no
/// longer be. `name` stands for the text in messages.
/// @throws ConfigError as LoadScenario.
Scenario ScenarioFromYaml(const std::string& resolved_yaml, const std::string& name);

/// The scenario as YAML, every key with its value; LoadScenario reads it back unchanged.
std::string ResolvedYaml(const Scenario& scenario, PathStyle style);

/// The scenario as a log's RUN_HEADER holds it: without what has no influence on the results
/// (how the run is spread over processes, where the input files lie), so that the same run makes
/// the same bytes everywhere. ScenarioFromYaml reads it.
std::string LogHeaderYaml(Scenario scenario);

}  // namespace windhover
