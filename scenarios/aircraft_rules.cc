#include "scenarios/aircraft_rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace windhover {
namespace {

// Closer than this two aircraft overlap, whatever they are.
constexpr double kLeastStartDistance_m = 0.3;
constexpr double kHub_m = 0.1;  // Radius of an aircraft's middle, which has something in it.

class AircraftRules {
 public:
  AircraftRules(const Scenario& scenario, RuleFindings& findings)
      : scenario_(scenario), findings_(findings) {}

  void CheckAll() {
    if (scenario_.aircraft.empty()) {
      findings_.MustBe("aircraft", "a list of at least one", "none");
    }
    CheckLaw();
    CheckMount();
    for (std::size_t i = 0; i < scenario_.aircraft.size(); ++i) CheckAircraft(i);
  }

 private:
  void CheckLaw() {
    const OlfatiSaberConfig& lattice = scenario_.swarm.olfati_saber;
    if (lattice.b < lattice.a) {
      findings_.MustBe("swarm.olfati_saber.b", fmt::format("at least a, {}", lattice.a),
                       fmt::format("'{}'", lattice.b), {"swarm.olfati_saber.a"});
    }
  }

  // A rig looks forward and up or down, so it sees its own aircraft from behind or above it.
  void CheckMount() {
    const CalibratedRig& rig = scenario_.rig.calibrated;
    const Eigen::Isometry3d X_BR = rig.X_BR();
    const double half_field_rad =
        std::atan(std::hypot(rig.image[0], rig.image[1]) / 2 / rig.FocalPx());
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Vector3d p_BC_m = X_BR * Eigen::Vector3d(side * rig.baseline_m, 0, 0);
      const double distance_m = p_BC_m.norm();
      if (distance_m <= kHub_m) continue;  // Mounted inside, as if the aircraft were transparent.
      const double from_axis_rad =
          std::acos(std::clamp(-p_BC_m.dot(X_BR.linear().col(2)) / distance_m, -1.0, 1.0));
      if (from_axis_rad > half_field_rad + std::asin(kHub_m / distance_m)) continue;
      const auto& at = rig.mount.position_m;
      findings_.MustBe(
          "rig.mount.position_m", "such that no camera looks into its own aircraft",
          fmt::format("'[{}, {}, {}]'", at[0], at[1], at[2]),
          {"rig.mount.pitch_deg", "rig.baseline_m", "rig.focal_mm", "rig.pixel_um", "rig.image"});
    }
  }

  void CheckGoal(const std::string& path, const Aircraft& aircraft) {
    const GoalConfig& goal = aircraft.self.goal;
    const bool is_given = goal.speed_mps > 0 || goal.position_m != GoalConfig{}.position_m;
    if (is_given && aircraft.self.controller != Controller::kSwarm) {
      findings_.MustBe(path + ".goal", "left out unless its controller is swarm", "a goal",
                       {path + ".controller"});
    } else if (is_given && goal.speed_mps == 0) {
      findings_.MustBe(path + ".goal.speed_mps", "above 0 for an aircraft with a goal", "'0'");
    }
  }

  void CheckAircraft(std::size_t i) {
    const Aircraft& aircraft = scenario_.aircraft[i];
    const std::string path = fmt::format("aircraft.{}", i);
    const Controller controller = aircraft.self.controller;
    findings_.CheckFile(path + ".trajectory.file", aircraft.trajectory.file,
                        controller == Controller::kTrajectory, "for controller trajectory",
                        path + ".controller");
    findings_.CheckFile(path + ".mesh.file", aircraft.mesh.file,
                        aircraft.type == AircraftType::kMesh, "for type mesh", path + ".type");
    const bool flies_by_sight =
        controller == Controller::kFollow || controller == Controller::kSwarm;
    if (flies_by_sight && !aircraft.self.carries_rig) {
      findings_.MustBe(path + ".carries_rig", "true for controller follow or swarm", "false",
                       {path + ".controller"});
    }
    if (controller == Controller::kFollow && scenario_.aircraft.size() < 2) {
      findings_.MustBe(path + ".controller", "follow only where there is another aircraft",
                       "one aircraft");
    }
    CheckGoal(path, aircraft);
    CheckWaypoints(path + ".waypoints", path + ".controller", aircraft);
    for (std::size_t j = 0; j < i; ++j) CheckPair(i, j);
  }

  void CheckWaypoints(const std::string& path, const std::string& controller_path,
                      const Aircraft& aircraft) {
    const std::vector<Waypoint>& waypoints = aircraft.waypoints;
    if (waypoints.empty() && aircraft.self.controller == Controller::kWaypoints) {
      findings_.MustBe(path, "a list of at least one for controller waypoints", "none",
                       {controller_path});
    }
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
      if (waypoints[i].time_s > waypoints[i - 1].time_s) continue;
      findings_.MustBe(fmt::format("{}.{}.time_s", path, i),
                       fmt::format("later than the one before, {}", waypoints[i - 1].time_s),
                       fmt::format("'{}'", waypoints[i].time_s),
                       {fmt::format("{}.{}.time_s", path, i - 1)});
    }
  }

  // Where an aircraft starts, unless only its trajectory file knows.
  static std::optional<std::array<double, 3>> StartOf(const Aircraft& aircraft) {
    if (aircraft.self.controller == Controller::kTrajectory) return std::nullopt;
    if (aircraft.self.controller != Controller::kWaypoints) return aircraft.position_m;
    if (aircraft.waypoints.empty()) return std::nullopt;
    return aircraft.waypoints.front().position_m;
  }

  void CheckPair(std::size_t i, std::size_t j) {
    const Aircraft& aircraft = scenario_.aircraft[i];
    const Aircraft& other = scenario_.aircraft[j];
    const std::string path = fmt::format("aircraft.{}", i);
    const std::string other_path = fmt::format("aircraft.{}", j);
    if (aircraft.self.id == other.self.id) {
      findings_.MustBe(path + ".id", "unlike that of every other aircraft",
                       fmt::format("'{}' again", other.self.id), {other_path + ".id"});
    }
    CheckDistance(i, j);
  }

  // Where scattered starts may be nearer than those of the file.
  void CheckDistance(std::size_t i, std::size_t j) {
    const Aircraft &aircraft = scenario_.aircraft[i], &other = scenario_.aircraft[j];
    const auto a = StartOf(aircraft), b = StartOf(other);
    if (!a || !b) return;
    const double scatter_m =
        std::sqrt(3) * scenario_.swarm.scatter_m * (IsScattered(aircraft) + IsScattered(other));
    const double least_m = std::max(kLeastStartDistance_m, scenario_.score.collision_m);
    const double distance_m =
        Eigen::Vector3d((*a)[0] - (*b)[0], (*a)[1] - (*b)[1], (*a)[2] - (*b)[2]).norm();
    if (distance_m >= least_m + scatter_m) return;
    const std::string path = fmt::format("aircraft.{}", i),
                      other_path = fmt::format("aircraft.{}", j);
    findings_.MustBe(
        path + ".position_m",
        scatter_m > 0
            ? fmt::format("at least {} m from aircraft {}, and {:.3g} m for swarm.scatter_m",
                          least_m, other.self.id, scatter_m)
            : fmt::format("at least {} m from aircraft {}", least_m, other.self.id),
        fmt::format("{:.3g} m", distance_m),
        {path + ".controller", path + ".waypoints", other_path + ".position_m",
         other_path + ".controller", other_path + ".waypoints", "score.collision_m",
         "swarm.scatter_m"});
  }

  static int IsScattered(const Aircraft& aircraft) {
    return aircraft.self.controller == Controller::kSwarm ? 1 : 0;
  }

  const Scenario& scenario_;
  RuleFindings& findings_;
};

}  // namespace

void CheckAircraftRules(const Scenario& scenario, RuleFindings& findings) {
  AircraftRules(scenario, findings).CheckAll();
}

}  // namespace windhover
