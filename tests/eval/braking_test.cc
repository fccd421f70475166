#include "eval/braking.h"

#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "swarm/collision_guard.h"

namespace windhover {
namespace {

using Eigen::Vector3d;

uav_truth_t Uav(int id, const Vector3d& p_m, const Vector3d& v_mps) {
  uav_truth_t uav{};
  uav.id = id;
  std::copy_n(p_m.data(), 3, uav.p_WB_m);
  std::copy_n(v_mps.data(), 3, uav.v_WB_mps);
  return uav;
}

bool MustBrake2(const Vector3d& own_v_mps, const Vector3d& p_m, const Vector3d& v_mps) {
  world_truth_t tick{};
  tick.uavs = {Uav(0, {1, 2, 3}, own_v_mps), Uav(1, Vector3d(1, 2, 3) + p_m, v_mps)};
  return MustBrake(SwarmConfig{}, tick.uavs[0], tick, own_v_mps);
}

// Stop 2.5 m before it with 1.5 m/s², a gain of 1 1/s and a reaction of 0.5 s: from 2 m/s
// (4 / 1.5 + 1.5) / 2 = 2.08 m and 1 m of reaction, 5.58 m in all; each of two that meet at 2 m/s
// needs 2.5 + 2 + 2 · 2.08 = 8.67 m.
TEST(MustBrake, WhereTheStoppingDistanceDoesNotSuffice) {
  EXPECT_FALSE(MustBrake2({2, 0, 0}, {5.59, 0, 0}, {0, 0, 0}));
  EXPECT_TRUE(MustBrake2({2, 0, 0}, {5.58, 0, 0}, {0, 0, 0}));
  EXPECT_FALSE(MustBrake2({2, 0, 0}, {8.67, 0, 0}, {-2, 0, 0}));
  EXPECT_TRUE(MustBrake2({2, 0, 0}, {8.66, 0, 0}, {-2, 0, 0}));
  EXPECT_FALSE(MustBrake2({2, 0, 0}, {3, 0, 0}, {2.5, 0, 0})) << "flies away faster";
}

TEST(MustBrake, NotForOnesThatPass) {
  EXPECT_FALSE(MustBrake2({2, 0, 0}, {4, 2.6, 0}, {0, 0, 0}));
  EXPECT_TRUE(MustBrake2({2, 0, 0}, {4, 2.4, 0}, {0, 0, 0}));
  EXPECT_FALSE(MustBrake2({2, 0, 0}, {-3, 0, 0}, {0, 0, 0})) << "behind";
}

// The guard itself, told the truth without a sigma, overrules what MustBrake() forbids.
TEST(MustBrake, IsWhatTheGuardDoesWhenItKnowsTheTruth) {
  RandomStream random(7, "braking");
  const auto draw = [&](double size) -> Vector3d {
    return size * Vector3d(random.Normal(), random.Normal(), random.Normal());
  };
  SwarmConfig config;
  config.guard.enabled = true;
  int n_braking = 0;
  for (int k = 0; k < 5000; ++k) {
    const Vector3d v_mps = draw(1), wish_mps = draw(1);
    config.max_speed_mps = wish_mps.norm() + 0.1;  // A wish is never faster.
    world_truth_t tick{};
    tick.uavs = {Uav(0, draw(2), v_mps)};
    std::vector<Neighbour> neighbours;
    for (int id = 1; id < 3; ++id) {
      tick.uavs.push_back(Uav(id, draw(2), draw(1)));
      neighbours.push_back({Vector3d(tick.uavs.back().p_WB_m) - Vector3d(tick.uavs.front().p_WB_m),
                            Vector3d(tick.uavs.back().v_WB_mps)});
    }
    const bool guarded =
        Guarded(config.guard, neighbours, v_mps, wish_mps, config.max_speed_mps).is_guarded;
    EXPECT_EQ(MustBrake(config, tick.uavs[0], tick, wish_mps), guarded) << k;
    n_braking += guarded;
  }
  EXPECT_GT(n_braking, 500);
  EXPECT_LT(n_braking, 4500);
}

}  // namespace
}  // namespace windhover
