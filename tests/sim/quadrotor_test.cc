#include "sim/quadrotor.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "common/geometry/rotation.h"
#include "sim/autopilot.h"

namespace windhover {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

const Vector3d kCalm = Vector3d::Zero();
constexpr double kStep_s = 0.002;

std::vector<QuadrotorParameters> BothTypes() {
  return {QuadrotorParametersOf(AircraftType::kM200Orange),
          QuadrotorParametersOf(AircraftType::kP600)};
}

Kinematics Level(double yaw_rad = 0) {
  Kinematics state;
  state.q_WB = Eigen::AngleAxisd(yaw_rad, Vector3d::UnitZ());
  return state;
}

TEST(Quadrotor, HoversAtTheSpeedsOfItsData) {
  const auto hover_radps = [](const QuadrotorParameters& my) {
    return std::sqrt(my.mass_kg * kGravity_mps2 / 4 / my.thrust_Ns2);
  };
  // 313 and 331 to 364 rad/s: propellers of 17 and 15.3 inch at C_T = 0.105.
  EXPECT_NEAR(hover_radps(BothTypes()[0]), 313, 1);
  EXPECT_NEAR(hover_radps(BothTypes()[1]), 355, 1);
  for (const QuadrotorParameters& my : BothTypes()) {
    const double ratio = 4 * my.largest_thrust_N / (my.mass_kg * kGravity_mps2);
    EXPECT_GT(ratio, 2);
    EXPECT_LT(ratio, 2.5);
  }
}

// V6.1
TEST(Quadrotor, HoverIsAnEquilibrium) {
  for (const QuadrotorParameters& my : BothTypes()) {
    const Kinematics rest = Level(0.3);
    const Trim trim = TrimFor(my, rest, kCalm);
    EXPECT_LT((trim.thrusts_N - Vector4d::Constant(my.mass_kg * kGravity_mps2 / 4)).norm(), 1e-9);
    Quadrotor quadrotor(my);
    quadrotor.Reset(rest, trim.thrusts_N);
    const Quadrotor::State slope =
        quadrotor.Derivative(quadrotor.state(), quadrotor.rotor_radps(), kCalm);
    EXPECT_LT(slope.head<17>().norm(), 1e-9);
  }
}

// The same in wind, on the move, and with the load off centre.
TEST(Quadrotor, TrimLeavesNoForceAndNoTorque) {
  for (QuadrotorParameters my : BothTypes()) {
    my.cg_B_m = {0.02, -0.01, 0.03};
    Kinematics state = Level();
    state.v_WB_mps = {5, -3, 1};
    state.a_WB_mps2 = {0.5, 1, -0.3};
    const Vector3d wind(-4, 6, 0.5);
    const Trim trim = TrimFor(my, state, wind);
    state.q_WB = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), trim.z_W);
    Quadrotor quadrotor(my);
    quadrotor.Reset(state, trim.thrusts_N);
    const Kinematics body = quadrotor.Body(wind);
    EXPECT_LT((body.a_WB_mps2 - state.a_WB_mps2).norm(), 1e-9);
    EXPECT_LT((body.p_WB_m - state.p_WB_m).norm(), 1e-12);
    const Quadrotor::State slope =
        quadrotor.Derivative(quadrotor.state(), quadrotor.rotor_radps(), wind);
    EXPECT_LT(slope.segment<3>(10).norm(), 1e-9);
    EXPECT_NE(trim.thrusts_N[0], trim.thrusts_N[2]);
  }
}

// V6.2
TEST(Quadrotor, FreeRotationKeepsMomentumAndEnergy) {
  QuadrotorParameters my = BothTypes()[0];
  my.inertia_kgm2 = {0.05, 0.08, 0.15};
  Quadrotor quadrotor(my);
  quadrotor.state().segment<3>(10) = Vector3d(2, 1, -3);
  const auto momentum_W = [&] {
    return Vector3d(quadrotor.q_WB() * my.inertia_kgm2.cwiseProduct(quadrotor.w_B_radps()));
  };
  const auto energy = [&] { return my.inertia_kgm2.dot(quadrotor.w_B_radps().cwiseAbs2()) / 2; };
  const Vector3d momentum_before = momentum_W();
  const double energy_before = energy();
  for (int i = 0; i < 5000; ++i) quadrotor.Step(kStep_s, Vector4d::Zero(), kCalm);
  EXPECT_LT((momentum_W() - momentum_before).norm() / momentum_before.norm(), 1e-6);
  EXPECT_LT(std::abs(energy() / energy_before - 1), 1e-6);
}

// V6.3: a fall with rotors at rest, v = v_t tanh(g t / v_t) with v_t² = 2 m g / (ρ C_d A).
TEST(Quadrotor, FallsAsFastAsItsDragAllows) {
  for (const QuadrotorParameters& my : BothTypes()) {
    Quadrotor quadrotor(my);
    const double terminal_mps =
        std::sqrt(2 * my.mass_kg * kGravity_mps2 / (1.225 * my.drag_area_m2));
    for (int i = 1; i <= 10'000; ++i) {
      quadrotor.Step(kStep_s, Vector4d::Zero(), kCalm);
      const double expected_mps =
          terminal_mps * std::tanh(kGravity_mps2 * i * kStep_s / terminal_mps);
      ASSERT_NEAR(quadrotor.state()[5], -expected_mps, 1e-8);
    }
  }
}

// V6.3: level flight through air at u needs tan(tilt) = (c_d ΣΩ u + ½ ρ C_d A u²) / (m g).
TEST(Quadrotor, SteadyFlightTiltsByItsDrag) {
  for (const QuadrotorParameters& my : BothTypes()) {
    for (const double u_mps : {2.0, 8.0, 15.0}) {
      Kinematics state = Level();
      state.v_WB_mps.x() = u_mps;
      const Trim trim = TrimFor(my, state, kCalm);
      const double sum_radps = (trim.thrusts_N / my.thrust_Ns2).cwiseSqrt().sum();
      const double drag_N =
          my.rotor_drag_kg * sum_radps * u_mps + 1.225 / 2 * my.drag_area_m2 * u_mps * u_mps;
      EXPECT_NEAR(trim.z_W.x() / trim.z_W.z(), drag_N / (my.mass_kg * kGravity_mps2), 1e-9);
      // About 8 degrees at 8 m/s.
      if (u_mps == 8) {
        EXPECT_NEAR(DegFromRad(std::acos(trim.z_W.z())), 8, 1);
      }
    }
  }
}

// V6.4
TEST(Quadrotor, MotorsReach63PercentInTheirTimeConstant) {
  for (const QuadrotorParameters& my : BothTypes()) {
    Quadrotor quadrotor(my);
    quadrotor.state().segment<4>(13).setConstant(300);
    for (int i = 0; i < 30; ++i) {
      quadrotor.Step(my.speed_up_s / 30, Vector4d::Constant(400), kCalm);
    }
    EXPECT_NEAR(quadrotor.rotor_radps()[2], 300 + 100 * (1 - std::exp(-1)), 1e-4);
    quadrotor.state().segment<4>(13).setConstant(400);
    for (int i = 0; i < 30; ++i) {
      quadrotor.Step(my.slow_down_s / 30, Vector4d::Constant(300), kCalm);
    }
    EXPECT_NEAR(quadrotor.rotor_radps()[1], 300 + 100 * std::exp(-1), 1e-4);
  }
}

// A tumbling climb in wind, for 0.4 s in n steps.
Quadrotor Tumbled(int n) {
  Quadrotor quadrotor(BothTypes()[1]);
  quadrotor.state().segment<3>(10) = Vector3d(3, -2, 1);
  quadrotor.state().segment<4>(13) = Vector4d(300, 310, 320, 330);
  for (int i = 0; i < n; ++i) {
    quadrotor.Step(0.4 / n, Vector4d(400, 410, 405, 395), Vector3d(5, 1, 0));
  }
  return quadrotor;
}

// V6.5
TEST(Quadrotor, RungeKuttaIsOfOrderFourAndKeepsTheQuaternionsLength) {
  const Quadrotor::State exact = Tumbled(6400).state();
  const auto error = [&](int n) { return (Tumbled(n).state() - exact).head<17>().norm(); };
  // Halving the step divides the error by 2⁴; at these steps, of a third to a twelfth of the
  // motors' time constant, higher orders still show.
  EXPECT_NEAR(std::log2(error(40) / error(80)), 4, 0.25);
  EXPECT_NEAR(std::log2(error(80) / error(160)), 4, 0.15);
  for (const int n : {40, 200, 6400}) EXPECT_NEAR(Tumbled(n).q_WB().norm(), 1, 1e-12);
}

TEST(Quadrotor, StateIsConsistent) {
  QuadrotorParameters my = BothTypes()[0];
  my.cg_B_m = {0.03, 0.02, -0.04};
  const Vector3d wind(3, 0, 0);
  Quadrotor before(my);
  before.state().segment<3>(10) = Vector3d(1, -0.5, 2);
  before.state().segment<4>(13) = Vector4d(300, 310, 320, 330);
  Quadrotor after = before;
  const double h_s = 1e-6;
  after.Step(h_s, after.rotor_radps(), wind);
  const Kinematics a = before.Body(wind), b = after.Body(wind);
  // Forward differences err by h / 2 of the next derivative, which is below 1e3.
  EXPECT_LT(((b.p_WB_m - a.p_WB_m) / h_s - a.v_WB_mps).norm(), 1e-3);
  EXPECT_LT(((b.v_WB_mps - a.v_WB_mps) / h_s - a.a_WB_mps2).norm(), 1e-3);
  EXPECT_NEAR(after.rotor_phase_rev()[3], h_s * 330 / (2 * EIGEN_PI), 1e-12);
}

// A body that turns about a centre of mass beside B's origin: 2 rad/s and 0.03 m make 0.06 m/s.
TEST(Quadrotor, StartsFromTheBodysState) {
  QuadrotorParameters my = BothTypes()[0];
  my.cg_B_m = {0.03, 0, 0};
  Kinematics body;
  body.p_WB_m = {1, 2, 3};
  body.v_WB_mps = {4, 5, 6};
  body.w_WB_B_radps = {0, 0, 2};
  Quadrotor quadrotor(my);
  quadrotor.Reset(body, Vector4d::Constant(10));
  EXPECT_LT((quadrotor.state().segment<3>(3) - Vector3d(4, 5.06, 6)).norm(), 1e-12);
  const Kinematics again = quadrotor.Body(kCalm);
  EXPECT_LT((again.p_WB_m - body.p_WB_m).norm(), 1e-12);
  EXPECT_LT((again.v_WB_mps - body.v_WB_mps).norm(), 1e-12);
}

TEST(Allocation, GivesTheForceAndTorqueAskedFor) {
  for (const QuadrotorParameters& my : BothTypes()) {
    for (const Vector3d& about : {Vector3d(0, 0, 0), Vector3d(0.03, -0.02, 0.05)}) {
      const Vector3d torque(0.4, -0.7, 0.05);
      const Vector4d thrusts = my.ThrustsFor(40, torque, about);
      EXPECT_NEAR(thrusts.sum(), 40, 1e-12);
      EXPECT_LT((my.TorqueOf(thrusts, about) - torque).norm(), 1e-12);
    }
    // Front rotors lift the nose: about B's y (left) that is a negative turn.
    EXPECT_LT(my.TorqueOf({10, 10, 9, 9}, kCalm).y(), 0);
    EXPECT_GT(my.TorqueOf({10, 9, 9, 10}, kCalm).x(), 0);  // Left ones roll to the right.
  }
}

TEST(Mixer, KeepsItsLimitsAndTiltsFirst) {
  const QuadrotorParameters my = BothTypes()[0];
  const double least_N = 0.5;
  const Vector3d small(0.3, -0.2, 0.02);
  const Vector4d exact = MixedThrusts(my, least_N, 44, small);
  EXPECT_NEAR(exact.sum(), 44, 1e-12);
  EXPECT_LT((my.TorqueOf(exact, kCalm) - small).norm(), 1e-12);
  for (const double force_N : {-50.0, 0.0, 44.0, 98.0, 1e6}) {
    for (const double tilt_Nm : {0.0, 3.0, 1e6}) {
      for (const double turn_Nm : {0.0, -1e6}) {
        const Vector4d thrusts = MixedThrusts(my, least_N, force_N, {tilt_Nm, 0, turn_Nm});
        EXPECT_GE(thrusts.minCoeff(), least_N);
        EXPECT_LE(thrusts.maxCoeff(), my.largest_thrust_N);
        const double possible_Nm = 2 * my.rotor_y_m * (my.largest_thrust_N - least_N);
        EXPECT_NEAR(my.TorqueOf(thrusts, kCalm).x(), std::min(tilt_Nm, possible_Nm), 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace windhover
