#include "swarm/follow_controller.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kDistance_m = 10;

AircraftConfig Config() {
  AircraftConfig config;
  config.rig.mount.position_m = {0, 0, 0};
  config.estimator.methods = {"baseline", "size"};
  config.estimator.in_loop = "baseline";
  return config;
}

FollowConfig Follow() {
  FollowConfig follow;
  follow.distance_m = kDistance_m;
  follow.gain_per_s = 0.8;
  follow.max_speed_mps = 5;
  return follow;
}

nav_state_t NavAt(int tick, const Vector3d& p_WB_m = Vector3d(0, 0, 20), double yaw_rad = 0) {
  nav_state_t nav{};
  nav.utime = tick * 100'000;
  nav.id = 3;
  std::copy_n(p_WB_m.data(), 3, nav.p_WB_m);
  nav.qw = std::cos(yaw_rad / 2);
  nav.qz = std::sin(yaw_rad / 2);
  return nav;
}

range_estimate_t Estimate(const Vector3d& p_RT_m, const std::string& method = "baseline") {
  range_estimate_t estimate{};
  estimate.method = method;
  estimate.status = range_estimate_t::STATUS_OK;
  std::copy_n(p_RT_m.data(), 3, estimate.p_RT_m);
  estimate.range_m = p_RT_m.norm();
  return estimate;
}

range_t Ranges(std::vector<range_estimate_t> estimates) {
  range_t ranges{};
  ranges.n_estimates = static_cast<int>(estimates.size());
  ranges.estimates = std::move(estimates);
  return ranges;
}

// The command after 3 s of the same sight, when no limit on acceleration acts any more.
velocity_command_t Settled(FollowController& controller, const range_t& ranges,
                           double yaw_rad = 0) {
  velocity_command_t command{};
  for (int tick = 0; tick < 100; ++tick) {
    command = controller.Control(NavAt(tick, {0, 0, 20}, yaw_rad), ranges);
  }
  return command;
}

TEST(FollowController, RestsAtItsDistance) {
  FollowController controller(Config(), Follow());
  const auto command = Settled(controller, Ranges({Estimate({0, 0, kDistance_m})}));
  EXPECT_LT(Vector3d(command.v_WB_mps).norm(), 1e-12);
  EXPECT_NEAR(command.yaw_rate_radps, 0, 1e-12);
  EXPECT_EQ(command.id, 3);
}

TEST(FollowController, ClosesInOnWhatIsFarAndBacksOffFromWhatIsNear) {
  FollowController far(Config(), Follow()), near(Config(), Follow());
  EXPECT_NEAR(Settled(far, Ranges({Estimate({0, 0, kDistance_m + 0.3})})).v_WB_mps[0], 0.24, 1e-9);
  EXPECT_NEAR(Settled(near, Ranges({Estimate({0, 0, kDistance_m - 0.3})})).v_WB_mps[0], -0.24,
              1e-9);
}

TEST(FollowController, FliesAlongTheLineOfSightOfItsOwnHeading) {
  FollowController controller(Config(), Follow());
  const auto command = Settled(controller, Ranges({Estimate({0, 0, 10.3})}), EIGEN_PI / 2);
  EXPECT_NEAR(command.v_WB_mps[0], 0, 1e-9);
  EXPECT_NEAR(command.v_WB_mps[1], 0.24, 1e-9);  // It looks north.
}

TEST(FollowController, TurnsTowardsTheTarget) {
  FollowController right(Config(), Follow()), left(Config(), Follow());
  // Rig frame: x is right; a turn to the right is negative about W's z.
  EXPECT_LT(Settled(right, Ranges({Estimate({1, 0, 10})})).yaw_rate_radps, -0.1);
  EXPECT_GT(Settled(left, Ranges({Estimate({-1, 0, 10})})).yaw_rate_radps, 0.1);
}

TEST(FollowController, MatchesHeight) {
  FollowController above(Config(), Follow()), below(Config(), Follow());
  EXPECT_GT(Settled(above, Ranges({Estimate({0, -0.5, 10})})).v_WB_mps[2], 0.3);  // y is down
  EXPECT_LT(Settled(below, Ranges({Estimate({0, 0.5, 10})})).v_WB_mps[2], -0.3);
}

TEST(FollowController, RespectsMountAndTilt) {
  AircraftConfig config = Config();
  config.rig.mount.position_m = {0.5, 0, 0};
  config.rig.mount.pitch_deg = 30;
  FollowController controller(config, Follow());
  // A target 30 degrees below the upward-looking axis is at the aircraft's own height.
  const double angle = EIGEN_PI / 6;
  const auto command = Settled(
      controller,
      Ranges({Estimate({0, kDistance_m * std::sin(angle), kDistance_m * std::cos(angle)})}));
  EXPECT_LT(Vector3d(command.v_WB_mps).norm(), 1e-9);
}

TEST(FollowController, KeepsItsLimits) {
  FollowConfig follow = Follow();
  follow.max_speed_mps = 2;
  FollowController controller(Config(), follow);
  Vector3d last = Vector3d::Zero();
  for (int tick = 0; tick < 100; ++tick) {
    const Vector3d v(controller.Control(NavAt(tick), Ranges({Estimate({3, -20, 500})})).v_WB_mps);
    EXPECT_LE(v.norm(), 2 + 1e-9);
    EXPECT_LE((v - last).norm(), controller.GentleAcceleration_mps2() * 0.1 + 1e-9);
    last = v;
  }
  EXPECT_NEAR(last.norm(), 2, 1e-9);
}

// 12 mm on 720 rows of 3.7 um: half the field is 6.4 degrees; 0.6 of it are 3.8 degrees of tilt.
TEST(FollowController, AcceleratesWithinTheFieldOfView) {
  const FollowController controller(Config(), Follow());
  EXPECT_NEAR(std::atan(controller.GentleAcceleration_mps2() / 9.80665) * 180 / EIGEN_PI, 3.83,
              0.01);
}

TEST(FollowController, GetsAwayFromWhatIsVeryNear) {
  FollowController controller(Config(), Follow());
  EXPECT_NEAR(controller.Control(NavAt(0), Ranges({Estimate({0, 0, 6})})).v_WB_mps[0],
              -controller.GentleAcceleration_mps2() * 0.1, 1e-9);
  FollowController threatened(Config(), Follow());
  EXPECT_NEAR(threatened.Control(NavAt(0), Ranges({Estimate({0, 0, 4})})).v_WB_mps[0], -0.3, 1e-9);
}

TEST(FollowController, FollowsTheNearestByTheMethodInLoop) {
  FollowController controller(Config(), Follow());
  range_estimate_t failed = Estimate({0, 0, 2});
  failed.status = range_estimate_t::STATUS_NO_ESTIMATE;
  range_estimate_t broken = Estimate({0, 0, 3});
  broken.p_RT_m[0] = std::numeric_limits<double>::quiet_NaN();
  const auto command = Settled(controller, Ranges({Estimate({0, 0, 40}), Estimate({0, 0, 10.3}),
                                                   Estimate({0, 0, 4}, "size"), failed, broken}));
  EXPECT_NEAR(command.v_WB_mps[0], 0.24, 1e-9);
}

TEST(FollowController, BridgesMissedFramesThenHovers) {
  FollowController controller(Config(), Follow());
  for (int tick = 0; tick < 50; ++tick)
    controller.Control(NavAt(tick), Ranges({Estimate({0, 0, 10.5})}));
  velocity_command_t command{};
  int tick = 50;
  for (; tick < 59; ++tick) command = controller.Control(NavAt(tick), {});
  EXPECT_NEAR(command.v_WB_mps[0], 0.4, 1e-9);  // 0.9 s later it still believes in the target.
  for (; tick < 80; ++tick) command = controller.Control(NavAt(tick), {});
  EXPECT_EQ(Vector3d(command.v_WB_mps), Vector3d::Zero());
  EXPECT_EQ(command.yaw_rate_radps, 0);
}

TEST(FollowController, HoversUntilItSeesSomething) {
  FollowController controller(Config(), Follow());
  EXPECT_EQ(Vector3d(controller.Control(NavAt(0), {}).v_WB_mps), Vector3d::Zero());
}

}  // namespace
}  // namespace windhover
