#include "sim/onboard_sensors.h"

#include <cmath>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

Scenario ThreeAircraft() {
  Scenario scenario;
  for (int i = 0; i < 3; ++i) {
    Aircraft aircraft;
    aircraft.self.id = 10 * i;
    aircraft.position_m = {3.0 * i, 4.0 * i, 5};
    aircraft.yaw_deg = 30;
    scenario.aircraft.push_back(aircraft);
  }
  return scenario;
}

TEST(OnboardSensors, WithoutNoiseTellTheTruth) {
  Scenario scenario = ThreeAircraft();
  scenario.nav.position_sigma_m = scenario.nav.velocity_sigma_mps =
      scenario.nav.attitude_sigma_deg = 0;
  const World world(scenario);
  const OnboardSensors sensors(scenario);
  const nav_state_t nav = sensors.Nav(world, 1, 7);
  EXPECT_EQ(nav.id, 10);
  EXPECT_EQ(Vector3d(nav.p_WB_m), Vector3d(3, 4, 5));
  EXPECT_EQ(Vector3d(nav.v_WB_mps), Vector3d::Zero());
  EXPECT_NEAR(2 * std::atan2(nav.qz, nav.qw), RadFromDeg(30), 1e-12);
}

TEST(OnboardSensors, ImuFeelsGravity) {
  const Scenario scenario = ThreeAircraft();
  const OnboardSensors sensors(scenario);
  const imu_t imu = sensors.Imu(World(scenario), 0, 3);
  // Five standard deviations of 0.05 m/s².
  EXPECT_NEAR(imu.specific_force_B_mps2[2], 9.80665, 0.25);
  EXPECT_NEAR(imu.specific_force_B_mps2[0], 0, 0.25);
  EXPECT_NEAR(imu.gyro_B_radps[2], 0, 0.01);
}

// A leader that speeds up: thrust stays along B's z, so the IMU feels nothing sideways.
TEST(OnboardSensors, ImuOfAFlyingMultirotorFeelsOnlyItsThrust) {
  Scenario scenario = ThreeAircraft();
  scenario.aircraft[0].self.controller = Controller::kWaypoints;
  scenario.aircraft[0].waypoints = {{0, {0, 0, 5}, 0}, {4, {10, 0, 5}, 0}};
  World world(scenario);
  world.AdvanceTo(500'000);
  const imu_t imu = OnboardSensors(scenario).Imu(world, 0, 100);
  EXPECT_GT(world.State(0).a_WB_mps2.x(), 1);
  EXPECT_NEAR(imu.specific_force_B_mps2[0], 0, 0.25);
  EXPECT_GT(imu.specific_force_B_mps2[2], 9.9 - 0.25);
}

// 20000 samples pin a standard deviation to 0.5 % and a mean to 0.7 % of it.
TEST(OnboardSensors, NoiseHasItsSigma) {
  const Scenario scenario = ThreeAircraft();
  const World world(scenario);
  const OnboardSensors sensors(scenario);
  double x_squares = 0, angle_squares = 0, xy = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const nav_state_t nav = sensors.Nav(world, 0, i);
    x_squares += nav.p_WB_m[0] * nav.p_WB_m[0];
    xy += nav.p_WB_m[0] * nav.p_WB_m[1];
    const Eigen::Quaterniond q(nav.qw, nav.qx, nav.qy, nav.qz);
    angle_squares += std::pow(q.angularDistance(world.State(0).q_WB), 2);
  }
  EXPECT_NEAR(std::sqrt(x_squares / kSamples), 0.02, 0.02 * 0.02);
  EXPECT_NEAR(xy / x_squares, 0, 0.03);
  EXPECT_NEAR(std::sqrt(angle_squares / kSamples / 3), RadFromDeg(0.1), RadFromDeg(0.1) * 0.02);
}

TEST(OnboardSensors, NoiseDependsOnSampleAndAircraftOnly) {
  const Scenario scenario = ThreeAircraft();
  const World world(scenario);
  const OnboardSensors a(scenario), b(scenario);
  b.Nav(world, 2, 9);
  EXPECT_EQ(a.Nav(world, 0, 4).p_WB_m[0], b.Nav(world, 0, 4).p_WB_m[0]);
  EXPECT_NE(a.Nav(world, 0, 4).p_WB_m[0], a.Nav(world, 0, 5).p_WB_m[0]);
  EXPECT_NE(a.Nav(world, 0, 4).p_WB_m[0], a.Nav(world, 2, 4).p_WB_m[0] - 6);
  EXPECT_EQ(a.Nav(world, 0, -1).p_WB_m[0], b.Nav(world, 0, -1).p_WB_m[0]);
}

}  // namespace
}  // namespace windhover
