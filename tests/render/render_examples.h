#pragma once

#include <algorithm>
#include <cmath>

#include "common/geometry/rotation.h"
#include "lcmtypes/world_truth_t.hpp"
#include "scenarios/scenario.h"

namespace windhover {

/// A small rig on aircraft 0 and on aircraft 2, which look east past targets.
inline Scenario ExampleScenario(Observe observe) {
  Scenario scenario;
  scenario.description = "test";
  scenario.random_seed = 5;
  scenario.observe = observe;
  scenario.sensor.noise = true;
  CalibratedRig& rig = scenario.rig.calibrated;
  rig.image = {640, 360};
  rig.pixel_um = 7.465;
  rig.distortion.k1 = -0.1;
  scenario.rig.misalignment.offset_px = 20;
  scenario.rig.misalignment.roll_deg = 0.3;
  const std::array types = {AircraftType::kP600, AircraftType::kM200Orange, AircraftType::kP600,
                            AircraftType::kM200Black};
  for (int id = 0; id < 4; ++id) {
    Aircraft aircraft;
    aircraft.self.id = id;
    aircraft.self.carries_rig = id % 2 == 0;
    aircraft.type = types[static_cast<std::size_t>(id)];
    scenario.aircraft.push_back(aircraft);
  }
  return scenario;
}

/// Its propellers turn by half in the 2 ms of an exposure, which shows whole discs.
inline uav_truth_t TruthAt(int id, const Eigen::Vector3d& p_WB_m, double yaw_deg = 0) {
  uav_truth_t uav{};
  uav.id = id;
  Eigen::Map<Eigen::Vector3d>(uav.p_WB_m) = p_WB_m;
  uav.qw = std::cos(RadFromDeg(yaw_deg) / 2);
  uav.qz = std::sin(RadFromDeg(yaw_deg) / 2);
  std::fill_n(uav.rotor_rate_hz, 4, 250);
  return uav;
}

/// Aircraft 1 is 12 m ahead of 0, 3 is 20 m ahead, partly behind 1; 2 hovers beside 0.
inline world_truth_t ExampleWorld() {
  world_truth_t world{};
  world.utime = 300'000;
  world.uavs = {TruthAt(0, {0, 0, 10}), TruthAt(1, {12, 0.4, 10.1}, 30), TruthAt(2, {0, 3, 10}),
                TruthAt(3, {20, 0.9, 10.2}, -20)};
  world.n_uavs = 4;
  return world;
}

}  // namespace windhover
