#include "sim/world.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace windhover {
namespace {

using Eigen::Vector3d;

Scenario TwoAircraft() {
  Scenario scenario;
  scenario.duration_s = 3;
  Aircraft follower, leader;
  follower.self.id = 2;
  follower.self.controller = Controller::kFollow;
  follower.position_m = {1, 2, 3};
  leader.self.id = 5;
  leader.self.controller = Controller::kWaypoints;
  leader.waypoints = {{0, {10, 0, 3}, 0}, {3, {13, 0, 3}, 0}};
  scenario.aircraft = {follower, leader};
  return scenario;
}

TEST(World, StartsWhereTheScenarioSays) {
  const world_truth_t truth = World(TwoAircraft()).Truth();
  EXPECT_EQ(truth.utime, 0);
  ASSERT_EQ(truth.n_uavs, 2);
  EXPECT_EQ(truth.uavs[0].id, 2);
  EXPECT_EQ(truth.uavs[1].id, 5);
  EXPECT_EQ(Vector3d(truth.uavs[0].p_WB_m), Vector3d(1, 2, 3));
  EXPECT_EQ(truth.uavs[1].p_WB_m[0], 10);
  EXPECT_EQ(truth.uavs[0].n_modal, 0);
}

// Each start in its own direction, by at most scatter_m, by the seed alone.
TEST(World, ScattersTheSwarm) {
  Scenario scenario = TwoAircraft();
  scenario.swarm.scatter_m = 0.5;
  EXPECT_EQ(World(scenario).State(0).p_WB_m, Vector3d(1, 2, 3)) << "it follows";
  scenario.aircraft[0].self.controller = Controller::kSwarm;
  scenario.aircraft.push_back(scenario.aircraft[0]);
  scenario.aircraft[2].self.id = 7;
  const Vector3d first_m = World(scenario).State(0).p_WB_m - Vector3d(1, 2, 3);
  EXPECT_GT(first_m.norm(), 0);
  EXPECT_LE(first_m.cwiseAbs().maxCoeff(), 0.5);
  EXPECT_NE(World(scenario).State(2).p_WB_m, World(scenario).State(0).p_WB_m);
  EXPECT_EQ(World(scenario).State(1).p_WB_m, World(TwoAircraft()).State(1).p_WB_m);
  EXPECT_EQ(World(scenario).State(0).p_WB_m - Vector3d(1, 2, 3), first_m);
  scenario.random_seed = 2;
  EXPECT_NE(World(scenario).State(0).p_WB_m - Vector3d(1, 2, 3), first_m);
}

TEST(World, MovesThePrescribedAndTheCommanded) {
  World world(TwoAircraft());
  world.Command(0, {{1, 0, 0}, 0});
  world.AdvanceTo(3'000'000);
  EXPECT_NEAR(world.State(1).p_WB_m.x(), 13, 1e-12);
  // A step of 1 m/s loses the 0.4 s of its response.
  EXPECT_NEAR(world.State(0).p_WB_m.x(), 1 + 3 - 0.4, 1e-4);
  EXPECT_EQ(world.Truth().utime, 3'000'000);
  EXPECT_THROW(world.AdvanceTo(0), std::logic_error);
}

TEST(World, CommandsThatAreNoSpeedNeverReachTheDynamics) {
  World world(TwoAircraft());
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const FlightCommand& command :
       {FlightCommand{{kNan, 0, 0}, 0}, FlightCommand{{0, kInfinity, 0}, 0},
        FlightCommand{{0, 0, 0}, kNan}, FlightCommand{{101, 0, 0}, 0},
        FlightCommand{{0, 0, 0}, -kInfinity}}) {
    EXPECT_THROW(world.Command(0, command), std::invalid_argument);
  }
  world.AdvanceTo(1'000'000);
  EXPECT_EQ(world.State(0).p_WB_m, Vector3d(1, 2, 3));
}

TEST(World, RotorsCarryTheAircraft) {
  World world(TwoAircraft());
  world.AdvanceTo(500'000);
  const world_truth_t truth = world.Truth();
  for (int i = 0; i < 4; ++i) {
    // An M200 hovers at 46.6 to 53.8 revolutions per second (physical models), each rotor within
    // 3 % of another's.
    EXPECT_NEAR(truth.uavs[0].rotor_rate_hz[i], 50, 5);
    EXPECT_NEAR(truth.uavs[0].rotor_phase_rev[i], 0.5 * truth.uavs[0].rotor_rate_hz[i], 1e-9);
    // The leader speeds up at this moment: more thrust.
    EXPECT_GT(truth.uavs[1].rotor_rate_hz[i], 0.97 * truth.uavs[0].rotor_rate_hz[i]);
  }
  EXPECT_NE(truth.uavs[0].rotor_rate_hz[0], truth.uavs[0].rotor_rate_hz[1]);
}

TEST(World, RotorsShakeTheBarOfTheRig) {
  Scenario scenario = TwoAircraft();
  scenario.aircraft[0].self.carries_rig = true;
  scenario.flex.enabled = true;
  scenario.vibration.source = VibrationSource::kRotors;
  World world(scenario);
  for (int i = 0; i <= 20; ++i) {
    world.AdvanceTo(i * 100'000);
    const world_truth_t truth = world.Truth();
    ASSERT_EQ(truth.uavs[0].n_modal, 12);
    ASSERT_EQ(truth.uavs[0].modal_state.size(), 12U);
    EXPECT_EQ(truth.uavs[1].n_modal, 0);
    // Tones of about 3 m/s² below the mode's 117 Hz bend it by tens of um, at most ten times
    // that at resonance.
    const double up_m = truth.uavs[0].modal_state[2];
    EXPECT_NE(up_m, 0);
    EXPECT_LT(std::abs(up_m), 5e-4);
  }
}

TEST(World, ARigidBodyObeysForcesAndOthersStayAsTheyWere) {
  Scenario scenario = TwoAircraft();
  World kinematic(scenario);
  scenario.aircraft[0].dynamics = Dynamics::kRigidBody;
  scenario.wind.mean_mps = {0, 6, 0};
  World world(scenario);
  for (World* one : {&kinematic, &world}) {
    one->Command(0, {{1, 0, 0}, 0});
    one->AdvanceTo(2'000'000);
  }
  EXPECT_EQ(world.State(1).p_WB_m, kinematic.State(1).p_WB_m);
  EXPECT_EQ(world.Truth().uavs[1].rotor_rate_hz[2], kinematic.Truth().uavs[1].rotor_rate_hz[2]);
  // It gets where a faultless one would, leaning to the south against the wind.
  EXPECT_LT((world.State(0).p_WB_m - kinematic.State(0).p_WB_m).norm(), 0.3);
  EXPECT_LT((world.State(0).q_WB * Vector3d::UnitZ()).y(), -0.05);
  const uav_truth_t truth = world.Truth().uavs[0];
  EXPECT_NEAR(truth.rotor_phase_rev[0], 2 * truth.rotor_rate_hz[0], 1);
  EXPECT_NEAR(truth.rotor_rate_hz[0], 50, 1);
}

TEST(World, SplittingTheTimeChangesNothingThatMatters) {
  World one(TwoAircraft()), two(TwoAircraft());
  one.Command(0, {{2, 1, 0}, 0.3});
  two.Command(0, {{2, 1, 0}, 0.3});
  one.AdvanceTo(1'000'000);
  for (int i = 1; i <= 200; ++i) two.AdvanceTo(i * 5000);
  EXPECT_LT((one.State(0).p_WB_m - two.State(0).p_WB_m).norm(), 1e-9);
  EXPECT_LT(one.State(0).q_WB.angularDistance(two.State(0).q_WB), 1e-9);
}

TEST(NumberOfTicks, IsDurationTimesRate) {
  Scenario scenario;
  scenario.duration_s = 20;
  scenario.frame_rate_hz = 10;
  EXPECT_EQ(NumberOfTicks(scenario), 200);
  scenario.duration_s = 0.3;  // 0.3 · 10 is not exactly 3.
  EXPECT_EQ(NumberOfTicks(scenario), 3);
  scenario.duration_s = 0.001;
  EXPECT_EQ(NumberOfTicks(scenario), 1);
}

}  // namespace
}  // namespace windhover
