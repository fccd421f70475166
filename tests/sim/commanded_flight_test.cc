#include "sim/commanded_flight.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace windhover {
namespace {

using Eigen::Vector3d;

// Below the limit: v'' + 10 v' + 25 v = 25 command, at rest before, so
// v = command (1 - (1 + 5 t) exp(-5 t)).
TEST(CommandedFlight, StepResponseHasItsClosedForm) {
  for (const double tick_s : {0.1, 0.013}) {
    CommandedFlight flight({0, 0, 5}, 0);
    const FlightCommand command{{1, -0.5, 0.2}, 0};
    for (double t_s = tick_s; t_s < 2; t_s += tick_s) {
      flight.Advance(tick_s, command);
      const double share = 1 - (1 + 5 * t_s) * std::exp(-5 * t_s);
      EXPECT_LT((flight.State().v_WB_mps - share * command.v_WB_mps).norm(), 1e-6) << t_s;
    }
  }
}

TEST(CommandedFlight, ArrivesAtTheCommandWithoutOvershoot) {
  CommandedFlight flight({0, 0, 5}, 0);
  double fastest = 0;
  for (int i = 0; i < 100; ++i) {
    flight.Advance(0.1, {{20, 0, 0}, 0});
    fastest = std::max(fastest, flight.State().v_WB_mps.x());
    EXPECT_LT(flight.State().a_WB_mps2.norm(), 6 + 1e-9);
  }
  EXPECT_NEAR(flight.State().v_WB_mps.x(), 20, 1e-6);
  EXPECT_LT(fastest, 20 * 1.05);
}

TEST(CommandedFlight, StateIsConsistent) {
  CommandedFlight flight({0, 0, 5}, 0.4);
  const FlightCommand command{{3, 2, -1}, 0.5};
  flight.Advance(0.3, command);
  CommandedFlight later = flight;
  const double h = 1e-5;
  later.Advance(h, command);
  const Kinematics a = flight.State(), b = later.State();
  // Forward differences err by h / 2 of the next derivative: 1e-4 and less.
  EXPECT_LT(((b.p_WB_m - a.p_WB_m) / h - a.v_WB_mps).norm(), 1e-3);
  EXPECT_LT(((b.v_WB_mps - a.v_WB_mps) / h - a.a_WB_mps2).norm(), 1e-3);
  const Eigen::AngleAxisd turn(a.q_WB.conjugate() * b.q_WB);
  EXPECT_LT((turn.axis() * turn.angle() / h - a.w_WB_B_radps).norm(), 1e-3);
  EXPECT_LT((a.q_WB * Vector3d::UnitZ() - (a.a_WB_mps2 - GravityInWorld()).normalized()).norm(),
            1e-12);
}

TEST(CommandedFlight, TurnsAtTheCommandedRate) {
  CommandedFlight flight({0, 0, 5}, 0.1);
  flight.Advance(3, {{0, 0, 0}, 0.5});
  const Vector3d forward = flight.State().q_WB * Vector3d::UnitX();
  // An exponential approach of 0.2 s loses 0.2 s · 0.5 rad/s.
  EXPECT_NEAR(std::atan2(forward.y(), forward.x()), 0.1 + 0.5 * (3 - 0.2), 1e-6);
  EXPECT_NEAR(flight.State().w_WB_B_radps.z(), 0.5, 1e-6);
}

}  // namespace
}  // namespace windhover
