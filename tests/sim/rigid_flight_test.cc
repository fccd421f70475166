#include "sim/rigid_flight.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "sim/lockstep.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

Aircraft Flying(AircraftType type = AircraftType::kM200Orange) {
  Aircraft aircraft;
  aircraft.type = type;
  aircraft.dynamics = Dynamics::kRigidBody;
  aircraft.position_m = {1, 2, 20};
  aircraft.yaw_deg = 30;
  return aircraft;
}

WindConfig Steady(double east_mps) {
  WindConfig wind;
  wind.mean_mps = {east_mps, 0, 0};
  return wind;
}

const HoldPath kHold({1, 2, 20}, RadFromDeg(30));

double TiltOf(const Kinematics& state) { return std::acos((state.q_WB * Vector3d::UnitZ()).z()); }

TEST(RigidFlight, HoversWhereItIsTold) {
  for (const AircraftType type : {AircraftType::kM200Orange, AircraftType::kP600}) {
    RigidFlight flight(Flying(type), WindConfig{}, 1, &kHold);
    flight.AdvanceTo(5'000'000, {});
    EXPECT_LT((flight.State().p_WB_m - Vector3d(1, 2, 20)).norm(), 1e-6);
    EXPECT_LT(flight.State().a_WB_mps2.norm(), 1e-6);
    EXPECT_LT(TiltOf(flight.State()), 1e-6);
    EXPECT_NEAR(flight.Turning().phase_rev[1], 5 * flight.Turning().rate_hz[1], 1e-4);
  }
}

// V6.3 in the loop: starts trimmed, and finds the trim again after a gust of position.
TEST(RigidFlight, HoldsAgainstWindWithTheTiltThatDragNeeds) {
  const QuadrotorParameters my = QuadrotorParametersOf(AircraftType::kM200Orange);
  RigidFlight flight(Flying(), Steady(-8), 1, &kHold);
  for (const Utime utime : {1'000'000, 20'000'000}) {
    flight.AdvanceTo(utime, {});
    EXPECT_LT((flight.State().p_WB_m - Vector3d(1, 2, 20)).norm(), 1e-4) << utime;
  }
  double sum_radps = 0;
  for (const double rate_hz : flight.Turning().rate_hz) sum_radps += 2 * EIGEN_PI * rate_hz;
  const double drag_N = my.rotor_drag_kg * sum_radps * 8 + 1.225 / 2 * my.drag_area_m2 * 64;
  EXPECT_NEAR(std::tan(TiltOf(flight.State())), drag_N / (my.mass_kg * kGravity_mps2), 1e-5);
  EXPECT_GT((flight.State().q_WB * Vector3d::UnitZ()).x(), 0);  // Leans into the wind.
}

TEST(RigidFlight, AnOffCentreLoadMakesRotorsDiffer) {
  Aircraft aircraft = Flying();
  aircraft.cg_offset_m = {0.02, -0.01, 0.03};
  RigidFlight flight(aircraft, WindConfig{}, 1, &kHold);
  flight.AdvanceTo(10'000'000, {});
  EXPECT_LT((flight.State().p_WB_m - Vector3d(1, 2, 20)).norm(), 1e-5);
  const QuadrotorParameters my = QuadrotorParametersOf(aircraft.type);
  const double hover_hz =
      std::sqrt(my.mass_kg * kGravity_mps2 / 4 / my.thrust_Ns2) / (2 * EIGEN_PI);
  // T_i = m g / 4 (1 ± c_x / x ± c_y / y): front and right rotors carry more.
  const double front = 0.02 / my.rotor_x_m, right = 0.01 / my.rotor_y_m;
  EXPECT_NEAR(flight.Turning().rate_hz[0], hover_hz * std::sqrt(1 + front - right), 1e-3);
  EXPECT_NEAR(flight.Turning().rate_hz[1], hover_hz * std::sqrt(1 + front + right), 1e-3);
  EXPECT_NEAR(flight.Turning().rate_hz[2], hover_hz * std::sqrt(1 - front + right), 1e-3);
  EXPECT_NEAR(flight.Turning().rate_hz[3], hover_hz * std::sqrt(1 - front - right), 1e-3);
}

// Largest distance from a path of 20 m in 8 s that turns the heading as well, in wind `wind`.
double LargestDeviation_m(const WindConfig& wind) {
  const WaypointPath path({{1, {0, 0, 20}, 0}, {5, {14, 3, 22}, 90}, {9, {20, -2, 20}, 0}});
  RigidFlight flight(Flying(), wind, 1, &path);
  double largest_m = 0;
  for (int i = 0; i <= 1000; ++i) {
    flight.AdvanceTo(10'000 * i, {});
    const Kinematics state = flight.State();
    largest_m = std::max(largest_m, (state.p_WB_m - path.At(0.01 * i).p_WB_m).norm());
  }
  return largest_m;
}

TEST(RigidFlight, FollowsWaypoints) {
  // The path's jerk jumps at waypoints and the motors lag: centimetres. Drag is not fed forward:
  // 4 m/s of it are 0.6 m/s², held by the position error (2 1/s²) until the integral knows.
  EXPECT_LT(LargestDeviation_m(WindConfig{}), 0.35);
  EXPECT_GT(LargestDeviation_m(WindConfig{}), 1e-3);
  WindConfig gusty = Steady(5);
  gusty.turbulence = Turbulence::kModerate;
  EXPECT_GT(LargestDeviation_m(gusty), LargestDeviation_m(WindConfig{}));
  EXPECT_LT(LargestDeviation_m(gusty), 2);
}

TEST(RigidFlight, ObeysVelocityCommandsInWind) {
  RigidFlight flight(Flying(), Steady(5), 1, nullptr);
  flight.AdvanceTo(12'000'000, {{3, -2, 0.5}, 0.2});
  const Kinematics state = flight.State();
  EXPECT_LT((state.v_WB_mps - Vector3d(3, -2, 0.5)).norm(), 0.03);
  EXPECT_NEAR(state.w_WB_B_radps.norm(), 0.2, 0.01);
  const Vector3d forward = state.q_WB * Vector3d::UnitX();
  // Starts at 30 degrees and loses 0.2 s of turning.
  EXPECT_NEAR(std::atan2(forward.y(), forward.x()), RadFromDeg(30) + 0.2 * (12 - 0.2), 0.02);
}

// Commands as bad as World lets through: full speed, reversed every 0.3 s, spinning.
TEST(RigidFlight, BadCommandsCannotBlowItUp) {
  WindConfig wind = Steady(20);
  wind.turbulence = Turbulence::kSevere;
  Aircraft aircraft = Flying(AircraftType::kP600);
  aircraft.cg_offset_m = {0.05, 0.05, 0.05};
  RigidFlight flight(aircraft, wind, 1, nullptr);
  for (int i = 0; i < 200; ++i) {
    const double sign = i % 2 == 0 ? 1 : -1;
    flight.AdvanceTo(300'000 * Utime{i + 1}, {{70 * sign, -70 * sign, 10 * sign}, 100 * sign});
    const Kinematics state = flight.State();
    ASSERT_LT(state.v_WB_mps.norm(), 60) << i;
    ASSERT_LT(state.w_WB_B_radps.norm(), 30) << i;
    for (const double rate_hz : flight.Turning().rate_hz) {
      ASSERT_GT(rate_hz, 0);
      ASSERT_LE(rate_hz, QuadrotorParametersOf(aircraft.type).LargestSpeed_radps() / 6.28);
    }
  }
  // And it recovers.
  flight.AdvanceTo(120'000'000, {});
  EXPECT_LT(flight.State().v_WB_mps.norm(), 10);
  EXPECT_LT(TiltOf(flight.State()), RadFromDeg(50));
}

TEST(RigidFlight, SplittingTheTimeChangesNothingThatMatters) {
  WindConfig wind = Steady(3);
  wind.turbulence = Turbulence::kLight;
  RigidFlight one(Flying(), wind, 1, nullptr), two(Flying(), wind, 1, nullptr);
  const FlightCommand command{{2, 1, 0}, 0.3};
  one.AdvanceTo(2'000'000, command);
  for (int i = 1; i <= 300; ++i) two.AdvanceTo(2'000'000 * Utime{i} / 300, command);
  // Steps of 2 ms and parts of them differ by the error of RK4.
  EXPECT_LT((one.State().p_WB_m - two.State().p_WB_m).norm(), 1e-8);
  EXPECT_LT(one.State().q_WB.angularDistance(two.State().q_WB), 1e-8);
}

// Stays where kHold is until 1 s.
class LostPath : public Path {
 public:
  explicit LostPath(double then) : then_(then) {}
  Kinematics At(double t_s) const override {
    Kinematics state = kHold.At(t_s);
    if (t_s > 1) state.p_WB_m.y() = state.a_WB_mps2.x() = then_;
    return state;
  }

 private:
  double then_;
};

TEST(RigidFlight, WhatIsNotFiniteEndsTheRun) {
  const LostPath path(std::numeric_limits<double>::quiet_NaN());
  RigidFlight flight(Flying(), WindConfig{}, 1, &path);
  flight.AdvanceTo(1'000'000, {});
  try {
    flight.AdvanceTo(2'000'000, {});
    FAIL();
  } catch (const RunInvalid& e) {
    EXPECT_EQ(e.culprit, "sim");
    EXPECT_EQ(e.reason, "the reference of uav0 is not finite at 1.000 s");  // So its jerk.
  }
}

TEST(RigidFlight, AnAbsurdPathIsFollowedAsFarAsPossible) {
  for (const double absurd : {1e9, -1e160, 1e300}) {
    const LostPath path(absurd);
    RigidFlight flight(Flying(), WindConfig{}, 1, &path);
    flight.AdvanceTo(20'000'000, {});
    EXPECT_LT(flight.State().v_WB_mps.norm(), 60);
    EXPECT_LT(TiltOf(flight.State()), RadFromDeg(60));
  }
}

}  // namespace
}  // namespace windhover
