// The laws of flocking and avoidance, each against what its paper promises.

#include "swarm/flocking.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "swarm/collision_guard.h"
#include "swarm/flock_controller.h"
#include "swarm/orca.h"
#include "swarm/potential_laws.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

constexpr double kStep_s = 0.1;

std::vector<Neighbour> SomeNeighbours(int n) {
  RandomStream random(3, "neighbours");
  std::vector<Neighbour> neighbours;
  for (int i = 0; i < n; ++i) {
    neighbours.push_back({4 * Vector3d(random.Normal(), random.Normal(), random.Normal()),
                          Vector3d(random.Normal(), random.Normal(), random.Normal())});
  }
  return neighbours;
}

// V6.8: k_s / r = k_c r. At 2 m, 7 / 2 - 2 = 1.5 m/s apart; at 4 m, 4 - 7 / 4 together.
TEST(Reynolds, PairSettlesWhereSeparationIsCohesion) {
  const ReynoldsConfig config;
  const auto towards = [&](double r_m) {
    const std::array neighbour = {Neighbour{{r_m, 0, 0}, Vector3d::Zero()}};
    return ReynoldsVelocity(config, neighbour, Vector3d::Zero()).x();
  };
  EXPECT_NEAR(towards(2), -1.5, 1e-12);
  EXPECT_NEAR(towards(4), 2.25, 1e-12);
  EXPECT_NEAR(towards(std::sqrt(7.0)), 0, 1e-12);
  // Two that both obey: their distance shrinks by both velocities.
  for (double start_m : {1.0, 9.0}) {
    double r_m = start_m;
    for (int i = 0; i < 400; ++i) r_m -= 2 * 0.02 * towards(r_m);
    EXPECT_NEAR(r_m, std::sqrt(7.0), 1e-6);
  }
}

TEST(Reynolds, AlignsAndMigrates) {
  ReynoldsConfig config{.separation_m2ps = 0, .cohesion_per_s = 0, .alignment = 0.5};
  const std::array neighbours = {Neighbour{{1, 0, 0}, {2, 0, 0}}, Neighbour{{0, 1, 0}, {0, 4, 0}}};
  EXPECT_EQ(ReynoldsVelocity(config, neighbours, {0, 0, 1}), Vector3d(0.5, 1, 1));
  EXPECT_EQ(ReynoldsVelocity(config, {}, {0, 0, 1}), Vector3d(0, 0, 1));
}

// 20 m apart, 5.67 m too near, at 0.4 1/s; far apart, and friction of what exceeds 0.5 m/s.
TEST(Vasarhelyi, RepelsAndRubs) {
  const VasarhelyiConfig config;
  const Vector3d still = Vector3d::Zero();
  const std::array near = {Neighbour{{0, 20, 0}, still}};
  EXPECT_NEAR(VasarhelyiVelocity(config, near, still, still).y(), -0.4 * 5.67, 1e-12);
  const std::array passing = {Neighbour{{0, 30, 0}, {3, 0, 0}}};
  EXPECT_NEAR(VasarhelyiVelocity(config, passing, still, still).x(), 0.0238 * 2.5, 1e-12);
  // Oneself at 3 m/s too: nothing to rub.
  EXPECT_EQ(VasarhelyiVelocity(config, passing, {3, 0, 0}, still), still);
  // At 100 m, 64.33 m beyond: the braking curve allows √(2 a r - (a/p)²) = 16.8 m/s.
  const std::array far = {Neighbour{{0, 100, 0}, {3, 0, 0}}};
  EXPECT_EQ(VasarhelyiVelocity(config, far, still, {1, 0, 0}), Vector3d(1, 0, 0));
}

TEST(BrakingSpeed, WorkedExample) {
  EXPECT_DOUBLE_EQ(BrakingSpeed(0.5, 0.8, 0.5), 0.4);  // below the knee of 0.5 / 0.8² m
  // Above it: √(2 · 0.5 · 5 - (0.5 / 0.8)²) = 2.147.
  EXPECT_NEAR(BrakingSpeed(5, 0.8, 0.5), 2.147, 1e-3);
  EXPECT_EQ(BrakingSpeed(-5, 0.8, 0.5), -BrakingSpeed(5, 0.8, 0.5));
  EXPECT_EQ(BrakingSpeed(5, 0, 0.5), 0);
}

TEST(BrakingSpeed, IsContinuousAndCanBeBraked) {
  for (double error_m = 0; error_m < 20; error_m += 0.01) {
    const double h = 1e-6, v = BrakingSpeed(error_m, 0.8, 0.5);
    const double slope = (BrakingSpeed(error_m + h, 0.8, 0.5) - v) / h;
    EXPECT_LE(slope, 0.8 + 1e-6);
    EXPECT_LE(slope * v, 0.5 + 1e-5) << "deceleration at " << error_m;  // dv/dt = dv/de · v
  }
}

// V6.9: slope p at 0, continuous, and from speed v it takes (v² / a + a / p²) / 2 to stop.
TEST(BrakingSpeed, StopsInItsDistance) {
  for (const double p : {0.4, 1.0, 3.0}) {
    for (const double a : {0.5, 2.5}) {
      EXPECT_NEAR(BrakingSpeed(1e-6, p, a) / 1e-6, p, 1e-9);
      const double knee_m = a / (p * p);
      EXPECT_NEAR(BrakingSpeed(knee_m * (1 - 1e-9), p, a), BrakingSpeed(knee_m * (1 + 1e-9), p, a),
                  1e-8 * a / p);
      for (const double v : {1.0, 4.0}) {
        if (v < a / p) continue;  // Slower, it is on the line.
        EXPECT_NEAR(BrakingSpeed((v * v / a + a / (p * p)) / 2, p, a), v, 1e-12);
      }
    }
  }
}

TEST(StoppingDistance, IsWhatBrakingSpeedTakes) {
  // 4 m/s at 2 m/s² and 1 1/s: (16 / 2 + 2) / 2 m; 1 m/s, below the knee of 2: 1 m.
  EXPECT_DOUBLE_EQ(StoppingDistance(4, 1, 2), 5);
  EXPECT_DOUBLE_EQ(StoppingDistance(1, 1, 2), 1);
  for (double v = -6; v <= 6; v += 0.25) {
    for (const double p : {0.4, 1.0, 3.0}) {
      // One rounding of a square root of at most 36.
      EXPECT_NEAR(BrakingSpeed(StoppingDistance(v, p, 1.5), p, 1.5), v, 1e-13);
    }
  }
}

// The acceleration or velocity that each law asks for.
std::vector<Vector3d> OfAllLaws(std::span<const Neighbour> neighbours, const Vector3d& v,
                                const Vector3d& wish) {
  return {ReynoldsVelocity({.alignment = 0.5}, neighbours, wish),
          OlfatiSaberAcceleration({}, neighbours, v, wish),
          VasarhelyiVelocity({}, neighbours, v, wish),
          OrcaVelocity({.radius_m = 0.5, .horizon_s = 3}, neighbours, v, wish, 2, kStep_s),
          PotentialFieldAcceleration({}, neighbours, v, wish)};
}

// V6.10: who is named first changes nothing but the last bits of sums, and of a search that is
// exact to 1e-9 m/s along borders that may meet at a hundredth of a radian.
TEST(Laws, DoNotDependOnTheOrderOfNeighbours) {
  const Vector3d v(0.3, -0.2, 0.1), wish(1, 0, 0);
  const GuardConfig guard{.enabled = true};
  for (const int n : {2, 3, 6, 10}) {
    for (const double scale : {0.5, 1.0, 3.0}) {
      std::vector<Neighbour> neighbours = SomeNeighbours(n);
      for (Neighbour& neighbour : neighbours) neighbour.p_m *= scale;
      const std::vector<Vector3d> before = OfAllLaws(neighbours, v, wish);
      const GuardedVelocity guarded = Guarded(guard, neighbours, v, wish, 2);
      std::reverse(neighbours.begin(), neighbours.end());
      const std::vector<Vector3d> after = OfAllLaws(neighbours, v, wish);
      for (std::size_t i = 0; i < before.size(); ++i) {
        EXPECT_LT((before[i] - after[i]).norm(), 1e-7) << "law " << i << ", " << n;
      }
      EXPECT_LT((Guarded(guard, neighbours, v, wish, 2).v_mps - guarded.v_mps).norm(), 1e-7);
    }
  }
}

// Two that meet on one line want each the mirror image of what the other wants.
TEST(Laws, AreSymmetricHeadOn) {
  for (const double distance_m : {1.5, 4.0, 9.0}) {
    for (const double aside_m : {0.0, 0.7}) {
      const Vector3d to_other(distance_m, aside_m, 0.2), v(1, 0, 0), wish(1.5, 0, 0);
      const std::array ahead = {Neighbour{to_other, -v}}, behind = {Neighbour{-to_other, v}};
      const std::vector<Vector3d> a = OfAllLaws(ahead, v, wish), b = OfAllLaws(behind, -v, -wish);
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] + b[i]).norm(), 1e-12) << i;
    }
  }
}

// ‖z‖σ = (√(1 + 0.1 · 40) − 1) / 0.1; z² = 40.
TEST(OlfatiSaber, WorkedExample) {
  EXPECT_NEAR(SigmaNorm(std::sqrt(40.0), 0.1), (std::sqrt(5.0) - 1) / 0.1, 1e-12);
  const OlfatiSaberConfig config;
  EXPECT_NEAR(OlfatiSaberAction(config, SigmaNorm(7, 0.1)), 0, 1e-12);
  EXPECT_NEAR(OlfatiSaberAction({.b = 9}, SigmaNorm(7, 0.1)), 0, 1e-12);
  EXPECT_EQ(OlfatiSaberAction(config, SigmaNorm(8.4, 0.1)), 0);  // From 1.2 · 7 m on.
  // Touching, far below h: −5 x / √(1 + x²), x = ‖7‖σ.
  const double x = (std::sqrt(1 + 4.9) - 1) / 0.1;
  EXPECT_NEAR(OlfatiSaberAction(config, 0), -5 * x / std::sqrt(1 + x * x), 1e-12);
}

// The potential of a distance, as the integral of the action by Simpson's rule.
double OlfatiSaberPotential(const OlfatiSaberConfig& config, double distance_m) {
  const double from = SigmaNorm(config.distance_m, config.epsilon);
  const double to = SigmaNorm(distance_m, config.epsilon);
  constexpr int kIntervals = 2000;
  const double h = (to - from) / kIntervals;
  double sum = 0;
  for (int i = 0; i <= kIntervals; ++i) {
    const int weight = i == 0 || i == kIntervals ? 1 : (i % 2 == 1 ? 4 : 2);
    sum += weight * OlfatiSaberAction(config, from + i * h);
  }
  return sum * h / 3;
}

// With no velocities to match the acceleration is −∂V / ∂(own position): central differences of
// 0.2 mm, good to 7e-9 of a third derivative of a few hundred.
TEST(OlfatiSaber, IsTheGradientOfItsPotential) {
  for (const double bump : {0.2, 0.9}) {
    for (const double b : {5.0, 9.0}) {  // The second with an uneven action.
      const OlfatiSaberConfig config{.bump = bump, .b = b, .gradient = 1.5};
      for (const Vector3d& q : {Vector3d(3, 1, 0), Vector3d(5, -4, 1), Vector3d(0.5, 6.8, 2)}) {
        const std::array neighbours = {Neighbour{q, Vector3d::Zero()},
                                       Neighbour{{-4, 3, 0.5}, Vector3d::Zero()}};
        const auto potential = [&](const Vector3d& own) {
          double sum = 0;
          for (const Neighbour& neighbour : neighbours) {
            sum += 1.5 * OlfatiSaberPotential(config, (neighbour.p_m - own).norm());
          }
          return sum;
        };
        const Vector3d force =
            OlfatiSaberAcceleration(config, neighbours, Vector3d::Zero(), Vector3d::Zero());
        for (int axis = 0; axis < 3; ++axis) {
          const Vector3d h = 2e-4 * Vector3d::Unit(axis);
          EXPECT_NEAR(force[axis], -(potential(h) - potential(-h)) / 4e-4, 5e-6);
        }
      }
    }
  }
}

TEST(OlfatiSaber, PairSettlesAtItsDistance) {
  const OlfatiSaberConfig config;
  for (const double start_m : {6.5, 8.0}) {  // Much nearer, they part for good.
    double r_m = start_m, closing_mps = 0;   // Of both together.
    for (int i = 0; i < 6000; ++i) {
      const std::array other = {Neighbour{{r_m, 0, 0}, {-closing_mps / 2, 0, 0}}};
      const Vector3d v(closing_mps / 2, 0, 0);
      closing_mps += 2 * 0.01 * OlfatiSaberAcceleration(config, other, v, Vector3d::Zero()).x();
      r_m -= 0.01 * closing_mps;
    }
    EXPECT_NEAR(r_m, 7, 1e-3) << start_m;
  }
}

// 3 m apart, of which 1 m are bodies: 20 (1/2 − 1/6) / 4 = 5/3 m/s²; and the potential's gradient.
TEST(PotentialField, RepelsByTheGradientOfItsPotential) {
  const PotentialFieldConfig config;
  const Vector3d none = Vector3d::Zero();
  const std::array near = {Neighbour{{0, 3, 0}, none}};
  EXPECT_NEAR(PotentialFieldAcceleration(config, near, none, none).y(), -5.0 / 3, 1e-12);
  const std::array far = {Neighbour{{0, 7, 0}, none}};
  EXPECT_EQ(PotentialFieldAcceleration(config, far, none, {1, 0, 0}), Vector3d(1.5, 0, 0));
  const auto potential = [&](const Vector3d& p) {
    const double gap = 1 / (p.norm() - config.body_m) - 1 / config.influence_m;
    return config.repulsion_m4ps2 / 2 * gap * gap;
  };
  for (const Vector3d& p : {Vector3d(2, 1, 0), Vector3d(-3, 2, 4)}) {
    const std::array neighbour = {Neighbour{p, none}};
    const Vector3d force = PotentialFieldAcceleration(config, neighbour, none, none);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d h = 1e-4 * Vector3d::Unit(axis);  // 1e-8 / 6 of a third derivative below 600.
      EXPECT_NEAR(force[axis], (potential(p + h) - potential(p - h)) / 2e-4, 1e-6);
    }
  }
}

// Two that want to go through each other at 1 m/s stop where 1.5 m/s² repel them.
TEST(PotentialField, PairStopsWhereRepulsionIsAttraction) {
  double r_m = 10, v_mps = 0;  // Each one's speed towards the other.
  for (int i = 0; i < 4000; ++i) {
    const std::array other = {Neighbour{{r_m, 0, 0}, {-v_mps, 0, 0}}};
    v_mps += 0.01 * PotentialFieldAcceleration({}, other, {v_mps, 0, 0}, {1, 0, 0}).x();
    r_m -= 2 * 0.01 * v_mps;
  }
  const double rho_m = r_m - 1;
  EXPECT_NEAR(20 * (1 / rho_m - 1 / 6.0) / (rho_m * rho_m), 1.5, 1e-6);
}

// 10 m ahead, 3 m to keep: at rest nothing collides; the cone's edge is at asin(0.3).
TEST(Orca, WorkedExample) {
  const OrcaConfig config{.radius_m = 1.5, .horizon_s = 100};
  const Neighbour ahead{{10, 0, 0}, Vector3d::Zero()};
  const SafeHalfSpace half = SafeVelocities(config, ahead, {1, 0.1, 0}, kStep_s);
  // Outward of the cone, on the side where the velocity is: turned by asin(0.3) from y.
  EXPECT_NEAR(half.normal.x(), -0.3, 1e-12);
  EXPECT_NEAR(half.normal.y(), std::sqrt(1 - 0.09), 1e-12);
  // Half of the way out: (0.3 - 0.1 cos) / 2 beyond where it is.
  const double now = -0.3 + 0.1 * std::sqrt(0.91);
  EXPECT_NEAR(half.offset_mps, now - now / 2, 1e-12);
}

// V6.7: two on one line, towards each other, pass on opposite sides and never touch.
TEST(Orca, HeadOnPairPassesWithoutTouching) {
  const OrcaConfig config{.radius_m = 1, .horizon_s = 5};
  for (const double aside_m : {0.0, 0.3}) {
    Vector3d p[2] = {{-10, aside_m, 0}, {10, 0, 0}};
    Vector3d v[2] = {{2, 0, 0}, {-2, 0, 0}};
    double least_m = 1e9;
    for (int i = 0; i < 200; ++i) {
      Vector3d next[2];
      for (int k = 0; k < 2; ++k) {
        const std::array other = {Neighbour{p[1 - k] - p[k], v[1 - k]}};
        next[k] = OrcaVelocity(config, other, v[k], {k == 0 ? 2.0 : -2.0, 0, 0}, 2, kStep_s);
      }
      for (int k = 0; k < 2; ++k) p[k] += kStep_s * (v[k] = next[k]);
      least_m = std::min(least_m, (p[0] - p[1]).norm());
    }
    EXPECT_GE(least_m, 2 * config.radius_m - 1e-6);
    EXPECT_GT(p[0].x(), 8);  // They did pass.
    EXPECT_LT(p[1].x(), -8);
    if (aside_m == 0) {
      EXPECT_LT((p[0] + p[1]).norm(), 1e-6);  // Each other's mirror image.
    }
  }
}

// Against 200,000 velocities tried at random: none is safe and nearer to the preferred one.
TEST(Orca, FindsTheNearestSafeVelocity) {
  RandomStream random(5, "velocities");
  for (int n : {1, 3, 6, 20}) {
    std::vector<SafeHalfSpace> safe;
    for (int i = 0; i < n; ++i) {
      const Vector3d normal = Vector3d(random.Normal(), random.Normal(), random.Normal());
      safe.push_back({normal.normalized(), 0.4 * random.Normal() - (n < 20 ? 0.3 : 0.9)});
    }
    const Vector3d wish(1.5, 1.5, 0);
    const Vector3d found = NearestSafeVelocity(safe, 2, wish);
    const auto breaks = [&](const Vector3d& v) {
      double worst = v.norm() - 2;
      for (const SafeHalfSpace& half : safe) {
        worst = std::max(worst, half.offset_mps - half.normal.dot(v));
      }
      return worst;
    };
    EXPECT_LT(breaks(found), 1e-8);
    for (int i = 0; i < 200'000; ++i) {
      const Vector3d v(random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(-2, 2));
      if (breaks(v) > 0) continue;
      ASSERT_GE((v - wish).norm(), (found - wish).norm() - 1e-9);
    }
  }
}

// v_x of at least 0.7 and at most -0.3 m/s: 0.2 breaks both by 0.5.
TEST(Orca, SharesWhatCannotBeKept) {
  const std::array<SafeHalfSpace, 2> safe = {SafeHalfSpace{{1, 0, 0}, 0.7},
                                             SafeHalfSpace{{-1, 0, 0}, 0.3}};
  EXPECT_LT((NearestSafeVelocity(safe, 2, {0.3, 0.4, 0}) - Vector3d(0.2, 0.4, 0)).norm(), 1e-6);
}

// Of twelve on alternating sides, the first ten.
TEST(Orca, TheNearestCount) {
  std::vector<Neighbour> neighbours;
  for (int i = 0; i < 12; ++i) {
    neighbours.push_back({{(i % 2 == 0 ? 1 : -1) * (4.0 + i), 1, 0}, Vector3d::Zero()});
  }
  const std::vector<Neighbour> nearest = Nearest(neighbours, 10);
  ASSERT_EQ(nearest.size(), 10U);
  EXPECT_EQ(nearest.front().p_m.x(), 4);
  EXPECT_EQ(nearest.back().p_m.x(), -13);
  EXPECT_EQ(Nearest(neighbours, 100).size(), 12U);
}

// One aircraft of a pair that see each other exactly, flown by its commands.
struct Flyer {
  nav_state_t nav{};
  double yaw_rad = 0;

  void Fly(const velocity_command_t& command) {
    nav.utime += 100'000;
    for (int axis = 0; axis < 3; ++axis) nav.p_WB_m[axis] += kStep_s * command.v_WB_mps[axis];
    std::copy_n(command.v_WB_mps, 3, nav.v_WB_mps);
    yaw_rad += kStep_s * command.yaw_rate_radps;
    nav.qw = std::cos(yaw_rad / 2);
    nav.qz = std::sin(yaw_rad / 2);
  }
};

range_t Sight(const Flyer& own, const Flyer& other, const AircraftConfig& config) {
  range_estimate_t estimate{};
  estimate.track_id = 4;
  estimate.method = "baseline";
  estimate.status = range_estimate_t::STATUS_OK;
  const Vector3d p_RT_m =
      (X_WB(own.nav) * config.rig.X_BR()).inverse() * Vector3d(other.nav.p_WB_m);
  std::copy_n(p_RT_m.data(), 3, estimate.p_RT_m);
  range_t ranges{};
  ranges.n_estimates = 1;
  ranges.estimates = {estimate};
  return ranges;
}

// The whole controller: from 12 m, turned away by 20 degrees, to √7 m, face to face.
TEST(FlockController, PairSettlesAndFacesEachOther) {
  AircraftConfig config;
  config.estimator.methods = {"baseline"};
  config.estimator.in_loop = "baseline";
  Flyer a, b;
  a.nav.qw = 1;
  b.nav.p_WB_m[0] = 12;
  b.yaw_rad = EIGEN_PI - 0.35;
  FlockController fly_a(config, {}), fly_b(config, {});
  for (int i = 0; i < 400; ++i) {
    const velocity_command_t to_a = fly_a.Control(a.nav, Sight(a, b, config));
    const velocity_command_t to_b = fly_b.Control(b.nav, Sight(b, a, config));
    a.Fly(to_a);
    b.Fly(to_b);
  }
  const Vector3d line = Vector3d(b.nav.p_WB_m) - Vector3d(a.nav.p_WB_m);
  EXPECT_NEAR(line.norm(), std::sqrt(7.0), 0.01);
  EXPECT_NEAR(std::remainder(a.yaw_rad - std::atan2(line.y(), line.x()), 2 * EIGEN_PI), 0, 0.01);
  EXPECT_NEAR(std::remainder(b.yaw_rad - std::atan2(-line.y(), -line.x()), 2 * EIGEN_PI), 0, 0.01);
}

// A second without sight it flies on where it believed the other to be; then it looks around.
TEST(FlockController, RemembersForASecondThenLooksAround) {
  AircraftConfig config;
  config.estimator.methods = {"baseline"};
  config.estimator.in_loop = "baseline";
  Flyer own, other;
  own.nav.qw = 1;
  other.nav.p_WB_m[0] = 12;
  FlockController controller(config, {});
  for (int i = 0; i < 20; ++i) own.Fly(controller.Control(own.nav, Sight(own, other, config)));
  const velocity_command_t soon = controller.Control(own.nav, {});
  EXPECT_GT(soon.v_WB_mps[0], 1);
  for (int i = 0; i < 30; ++i) own.Fly(controller.Control(own.nav, {}));
  const velocity_command_t later = controller.Control(own.nav, {});
  EXPECT_EQ(later.v_WB_mps[0], 0);
  EXPECT_GT(later.yaw_rate_radps, 0);
}

// 20 m to the goal, to be flown at 3 m/s: alone at 1 m/s, and it stops there.
TEST(FlockController, AloneItFliesToItsGoalSlowly) {
  AircraftConfig config;
  config.swarm.max_speed_mps = 5;
  Flyer own;
  own.nav.qw = 1;
  FlockController controller(config, {.position_m = {20, 0, 0}, .speed_mps = 3});
  double fastest_mps = 0;
  for (int i = 0; i < 400; ++i) {
    own.Fly(controller.Control(own.nav, {}));
    fastest_mps = std::max(fastest_mps, own.nav.v_WB_mps[0]);
  }
  EXPECT_NEAR(fastest_mps, 1, 1e-9);
  EXPECT_NEAR(own.nav.p_WB_m[0], 20, 0.01);
}

// Straight at one that stands, by a law that does not care: the guard stops it, and says so.
TEST(FlockController, SaysWhenTheGuardOverrulesItsLaw) {
  AircraftConfig config;
  config.swarm.controller = SwarmLaw::kNone;
  config.swarm.migration_mps = {1.5, 0, 0};
  for (const bool enabled : {true, false}) {
    config.swarm.guard.enabled = enabled;
    Flyer own, other;
    own.nav.qw = 1;
    other.nav.p_WB_m[0] = 12;
    FlockController controller(config, {});
    int n_guarded = 0;
    for (int i = 0; i < 75; ++i) {
      const velocity_command_t command = controller.Control(own.nav, Sight(own, other, config));
      n_guarded += command.is_guarded;
      if (i > 1) {  // Before, it knows of no other and flies slowly.
        EXPECT_NEAR(command.wish_WB_mps[0], 1.5, 1e-12);
      }
      own.Fly(command);
      if (i < 10) {
        EXPECT_EQ(n_guarded, 0) << "far away";
      }
    }
    EXPECT_EQ(n_guarded > 0, enabled);
    EXPECT_EQ(own.nav.p_WB_m[0] < 12 - config.swarm.guard.stop_m + 0.1, enabled);
  }
}

}  // namespace
}  // namespace windhover
