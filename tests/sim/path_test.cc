#include "sim/path.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "tests/support/scratch_file.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

double YawOf(const Kinematics& state) {
  const Vector3d forward = state.q_WB * Vector3d::UnitX();
  return std::atan2(forward.y(), forward.x());
}

// Every derivative that a path claims against differences of what it differentiates.
void ExpectDerivatives(const Path& path, double t_s, double tolerance) {
  const double h = 1e-5;
  const Kinematics before = path.At(t_s - h), now = path.At(t_s), after = path.At(t_s + h);
  const Vector3d v = (after.p_WB_m - before.p_WB_m) / (2 * h);
  const Vector3d a = (after.v_WB_mps - before.v_WB_mps) / (2 * h);
  const Eigen::AngleAxisd turn(before.q_WB.conjugate() * after.q_WB);
  const Vector3d w = turn.axis() * std::remainder(turn.angle(), 2 * EIGEN_PI) / (2 * h);
  EXPECT_LT((now.v_WB_mps - v).norm(), tolerance) << t_s;
  EXPECT_LT((now.a_WB_mps2 - a).norm(), tolerance) << t_s;
  EXPECT_LT((now.w_WB_B_radps - w).norm(), tolerance) << t_s;
}

const std::vector<Waypoint> kLegs = {{0, {10, 0, 20}, 0},     {2, {10, 0, 20}, 90},
                                     {9, {24, 1, 20.5}, 350}, {11, {24, 1, 20.5}, 10},
                                     {14, {20, 1, 20}, 0},    {18, {10, 0, 20}, 0}};

TEST(HoldPath, Stays) {
  const Kinematics state = HoldPath({1, 2, 3}, 0.5).At(7);
  EXPECT_EQ(state.p_WB_m, Vector3d(1, 2, 3));
  EXPECT_EQ(state.v_WB_mps, Vector3d::Zero());
  EXPECT_NEAR(YawOf(state), 0.5, 1e-12);
}

TEST(WaypointPath, PassesThroughWaypoints) {
  const WaypointPath path(kLegs);
  for (const Waypoint& waypoint : kLegs) {
    const Kinematics state = path.At(waypoint.time_s);
    EXPECT_LT((state.p_WB_m - Vector3d(waypoint.position_m.data())).norm(), 1e-12);
    EXPECT_NEAR(std::remainder(YawOf(state) - RadFromDeg(waypoint.yaw_deg), 2 * EIGEN_PI), 0,
                1e-12);
    EXPECT_LT(state.a_WB_mps2.norm(), 1e-12);
  }
}

TEST(WaypointPath, DerivativesMatchDifferences) {
  const WaypointPath path(kLegs);
  // Differences of values around 25 m are good to 25 · 2e-16 / 1e-5 = 5e-10, twice that for
  // angles; h² / 6 · f''' is below 1e-8.
  for (double t_s = 0.05; t_s < 17.9; t_s += 0.1) ExpectDerivatives(path, t_s, 1e-6);
}

TEST(WaypointPath, RestsAndNeverOvershoots) {
  const WaypointPath path(kLegs);
  EXPECT_EQ(path.At(-1).p_WB_m, Vector3d(10, 0, 20));
  EXPECT_EQ(path.At(100).p_WB_m, Vector3d(10, 0, 20));
  for (double t_s = 0; t_s < 18; t_s += 0.01) {
    const Kinematics state = path.At(t_s);
    EXPECT_GE(state.p_WB_m.x(), 10 - 1e-9);
    EXPECT_LE(state.p_WB_m.x(), 24 + 1e-9);
    const bool rests = t_s < 2 || (t_s > 9 && t_s < 11);
    if (rests) {
      EXPECT_LT(state.v_WB_mps.norm(), 1e-9) << t_s;
    }
  }
}

TEST(WaypointPath, OneWaypointIsAPlace) {
  EXPECT_EQ(WaypointPath({{5, {1, 2, 3}, 0}}).At(2).p_WB_m, Vector3d(1, 2, 3));
}

TEST(WaypointPath, TiltsIntoItsAcceleration) {
  // 2 m/s² forward tilts thrust by atan(2 / 9.81) = 11.5 degrees, so the nose goes down.
  const WaypointPath path({{0, {0, 0, 0}, 0}, {4, {10, 0, 0}, 0}});
  const Kinematics state = path.At(0.5);
  const Vector3d thrust = state.a_WB_mps2 - GravityInWorld();
  EXPECT_GT(state.a_WB_mps2.x(), 1);
  EXPECT_LT((state.q_WB * Vector3d::UnitZ() - thrust.normalized()).norm(), 1e-12);
  EXPECT_LT((state.q_WB * Vector3d::UnitX()).z(), 0);
}

// A circle of 2 m in 8 s, the body turning with it.
std::string CircleFile(bool with_attitude) {
  std::string text;
  for (int i = 0; i <= 200; ++i) {
    const double t_s = 100 + i * 0.05, angle = 2 * EIGEN_PI * i * 0.05 / 8;
    const double half = with_attitude ? angle / 2 : 0.25;
    text += fmt::format("{:.6f} {:.12f} {:.12f} 1 0 0 {:.12f} {:.12f}\n", t_s, 2 * std::cos(angle),
                        2 * std::sin(angle), std::sin(half), std::cos(half));
  }
  return test::ScratchFile(text, with_attitude ? "turning" : "fixed");
}

TrajectoryConfig Config(const std::string& file) {
  TrajectoryConfig config;
  config.file = {file, file, "s.yaml:3:7"};
  return config;
}

TEST(RecordedPath, FollowsTheRecording) {
  const RecordedPath path(Config(CircleFile(true)), 9);
  const double w = 2 * EIGEN_PI / 8;
  for (double t_s = 0.5; t_s < 8.5; t_s += 0.037) {
    const Kinematics state = path.At(t_s);
    const Vector3d radius(std::cos(w * t_s), std::sin(w * t_s), 0);
    // A cubic spline through points h apart errs by 5/384 · h⁴ · |f''''| = 6e-8 m here; the file
    // has twelve digits. Its ends have no acceleration: that error fades within a few points.
    EXPECT_LT((state.p_WB_m - (2 * radius + Vector3d(0, 0, 1))).norm(), 1e-6);
    EXPECT_LT((state.v_WB_mps - 2 * w * Vector3d(-radius.y(), radius.x(), 0)).norm(), 1e-4);
    EXPECT_LT((state.a_WB_mps2 + 2 * w * w * radius).norm(), 1e-3);
    EXPECT_LT((state.w_WB_B_radps - Vector3d(0, 0, w)).norm(), 1e-9);
    EXPECT_NEAR(std::remainder(YawOf(state) - w * t_s, 2 * EIGEN_PI), 0, 1e-9);
    ExpectDerivatives(path, t_s, 1e-4);
  }
}

TEST(RecordedPath, ScalesTurnsShiftsAndHurries) {
  TrajectoryConfig config = Config(CircleFile(true));
  const RecordedPath plain(config, 2);
  config.scale = 3;
  config.yaw_deg = 90;
  config.offset_m = {10, 20, 30};
  config.start_s = 1;
  config.speed = 2;
  const RecordedPath path(config, 2);
  const Kinematics a = plain.At(1 + 2 * 0.7), b = path.At(0.7);
  const auto turned = [](const Vector3d& v) { return Vector3d(-v.y(), v.x(), v.z()); };
  EXPECT_LT((b.p_WB_m - (3 * turned(a.p_WB_m) + Vector3d(10, 20, 30))).norm(), 1e-9);
  EXPECT_LT((b.v_WB_mps - 6 * turned(a.v_WB_mps)).norm(), 1e-9);
  EXPECT_LT((b.a_WB_mps2 - 12 * turned(a.a_WB_mps2)).norm(), 1e-9);
  EXPECT_LT((b.w_WB_B_radps - 2 * a.w_WB_B_radps).norm(), 1e-9);
  EXPECT_NEAR(std::remainder(YawOf(b) - YawOf(a) - EIGEN_PI / 2, 2 * EIGEN_PI), 0, 1e-9);
}

TEST(RecordedPath, WithoutAttitudeTiltsIntoItsAcceleration) {
  const RecordedPath path(Config(CircleFile(false)), 9);
  const Kinematics state = path.At(3.3);
  const Vector3d thrust = state.a_WB_mps2 - GravityInWorld();
  EXPECT_LT((state.q_WB * Vector3d::UnitZ() - thrust.normalized()).norm(), 1e-12);
  EXPECT_NEAR(YawOf(state), 0.5, 0.05);
  ExpectDerivatives(path, 3.33, 1e-4);
}

TEST(RecordedPath, SaysWhenTheRecordingIsTooShort) {
  TrajectoryConfig config = Config(CircleFile(true));
  config.start_s = 4;
  EXPECT_NO_THROW(RecordedPath(config, 6));
  try {
    const RecordedPath path(config, 6.5);
    FAIL() << "accepted";
  } catch (const ConfigError& e) {
    EXPECT_THAT(e.what(), testing::StartsWith("s.yaml:3:7: trajectory.file: must be a recording of "
                                              "at least 10.5 s"));
    EXPECT_THAT(e.what(), testing::HasSubstr("found 10 s"));
  }
}

TEST(RecordedPath, FliesRecordedFlightsSmoothly) {
  const std::filesystem::path folder = WINDHOVER_REAL_INPUTS_DIR "/trajectories";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no recordings at " << folder;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const RecordedPath path(Config(entry.path()), 60);
    double fastest_mps = 0, hardest_mps2 = 0;
    for (double t_s = 0.1; t_s < 60; t_s += 0.0371) {
      const Kinematics state = path.At(t_s);
      fastest_mps = std::max(fastest_mps, state.v_WB_mps.norm());
      hardest_mps2 = std::max(hardest_mps2, state.a_WB_mps2.norm());
    }
    // The data set's flights reach 2.4 m/s; a spline that rings would show in the acceleration.
    EXPECT_LT(fastest_mps, 3) << entry.path();
    EXPECT_LT(hardest_mps2, 15) << entry.path();
  }
}

}  // namespace
}  // namespace windhover
