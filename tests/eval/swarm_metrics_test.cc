#include "eval/swarm_metrics.h"

#include <gtest/gtest.h>

#include "tests/eval/flight_fixture.h"

namespace windhover {
namespace {

uav_truth_t Uav(int id, double x_m, double vx_mps = 0, double vy_mps = 0) {
  uav_truth_t uav{};
  uav.id = id;
  uav.p_WB_m[0] = x_m;
  uav.v_WB_mps[0] = vx_mps;
  uav.v_WB_mps[1] = vy_mps;
  return uav;
}

world_truth_t World(std::vector<uav_truth_t> uavs, Utime utime = 0) {
  world_truth_t world{};
  world.utime = utime;
  world.n_uavs = static_cast<int>(uavs.size());
  world.uavs = std::move(uavs);
  return world;
}

SwarmMetrics MetricsOf(std::vector<world_truth_t> world, std::vector<ObserverFrame> frames = {}) {
  RunRecord run = Flight(std::move(frames));
  run.world = std::move(world);
  return ComputeSwarmMetrics(run, SwarmTicks(run));
}

TEST(SwarmMetrics, CountsEncountersOncePerApproach) {
  // Limits 1.5 m (near miss) and 0.6 m (collision): in, stays, closer, out, in again.
  std::vector<world_truth_t> world;
  for (const double gap_m : {5.0, 1.4, 1.3, 0.5, 2.0, 1.0}) {
    world.push_back(
        World({Uav(0, 0), Uav(1, gap_m)}, UtimeOfTick(static_cast<int>(world.size()), 10)));
  }
  const auto metrics = MetricsOf(world);
  EXPECT_DOUBLE_EQ(*metrics.min_separation_m, 0.5);
  EXPECT_EQ(metrics.collisions, 1);
  EXPECT_EQ(metrics.near_misses, 2);
}

TEST(SwarmMetrics, OneAircraftHasNoSeparation) {
  const auto metrics = MetricsOf({World({Uav(0, 0, 3)})});
  EXPECT_FALSE(metrics.min_separation_m);
  EXPECT_FALSE(metrics.collisions);
  EXPECT_FALSE(metrics.order);
  EXPECT_FALSE(metrics.connectivity);
}

TEST(SwarmMetrics, OrderIsOneInParallelFlightAndZeroHeadOn) {
  EXPECT_DOUBLE_EQ(*MetricsOf({World({Uav(0, 0, 3), Uav(1, 9, 5)})}).order, 1);
  EXPECT_DOUBLE_EQ(*MetricsOf({World({Uav(0, 0, 3), Uav(1, 9, -5)})}).order, 0);
  EXPECT_DOUBLE_EQ(*MetricsOf({World({Uav(0, 0, 3), Uav(1, 9, 0, 3)})}).order, std::sqrt(0.5));
}

/// Four in a row: 0 sees 1 and 1 sees 2, then nobody sees anybody.
SwarmMetrics MetricsOfThreeLinkedOnce() {
  const std::vector row{Uav(0, 0), Uav(1, 9), Uav(2, 18), Uav(3, 27)};
  ObserverFrame sees_one = SeenFrame(0, TargetAhead(1, 9), 9);
  ObserverFrame sees_two = SeenFrame(0, TargetAhead(2, 9), 9);
  sees_two.observer_id = 1;
  ObserverFrame blind = SeenFrame(100'000, TargetAhead(1, 9), 9);
  blind.truth.targets[0].left.in_front = 0;
  return MetricsOf({World(row), World(row, 100'000)}, {sees_one, sees_two, blind});
}

TEST(SwarmMetrics, ConnectivityIsTheLargestGroupThatSeesEachOther) {
  // 0-1-2 are linked at first: 3 of 4; then nobody: 1 of 4.
  EXPECT_DOUBLE_EQ(*MetricsOfThreeLinkedOnce().connectivity, 0.5);
}

// V6.10: λ₂ of a path of three is 1, of three that all see each other 3; of two groups 0.
TEST(SwarmMetrics, AlgebraicConnectivityIsZeroWhereGroupsArePart) {
  const auto lambda2 = [](int n, const std::vector<std::pair<int, int>>& sights) {
    world_truth_t world{};
    for (int id = 0; id < n; ++id) world.uavs.push_back(Uav(id, 9 * id));
    std::vector<ObserverFrame> frames;
    for (const auto& [from, to] : sights) {
      frames.push_back(SeenFrame(0, TargetAhead(to, 9), 9));
      frames.back().observer_id = from;
    }
    return n * *MetricsOf({world}, frames).algebraic_connectivity;
  };
  EXPECT_NEAR(lambda2(3, {{0, 1}, {1, 2}}), 1, 1e-12);
  EXPECT_NEAR(lambda2(3, {{0, 1}, {1, 2}, {2, 0}, {0, 2}}), 3, 1e-12);
  EXPECT_EQ(lambda2(4, {{0, 1}, {2, 3}}), 0);
  EXPECT_EQ(lambda2(4, {{0, 1}, {1, 2}}), 0);
  // A path of n: 2 - 2 cos(π / n).
  EXPECT_NEAR(lambda2(4, {{0, 1}, {1, 2}, {2, 3}}), 2 - std::sqrt(2.0), 1e-12);
}

// 0-1-2 are one group of four, so two groups: (4 - 2) / 3; then four groups: 0.
TEST(SwarmMetrics, UnionCountsGroups) {
  EXPECT_DOUBLE_EQ(*MetricsOfThreeLinkedOnce().union_by_sight, 1.0 / 3);
}

// 10 m apart, closing at 2 m/s: 1.5 m apart after 4.25 s. A target that passes 2 m beside never is.
TEST(SwarmMetrics, TimeToNearMissIsOfTheFirstDetection) {
  const auto at_first_sight = [](double north_m, double v_mps) {
    world_truth_t before = World({Uav(0, 0), Uav(1, 99)});
    world_truth_t tick = World({Uav(0, 0, 1), Uav(1, 10, 1 - v_mps)});
    tick.uavs[1].p_WB_m[1] = north_m;
    tick.utime = 100'000;
    world_truth_t after = World({Uav(0, 0, 1), Uav(1, 5, -9)});
    after.utime = 200'000;
    const std::vector frames = {MissedFrame(0, TargetAhead(1, 99)),
                                SeenFrame(100'000, TargetAhead(1, 10), 10),
                                SeenFrame(200'000, TargetAhead(1, 5), 5)};
    return MetricsOf({before, tick, after}, frames).first_sight_to_near_miss_s;
  };
  EXPECT_DOUBLE_EQ(*at_first_sight(0, 2), 4.25);
  EXPECT_FALSE(at_first_sight(2, 2));
  EXPECT_FALSE(at_first_sight(0, -2)) << "flies away";
}

// Track 5 shows target 1 three times, then target 2 once; track 6 what is no target.
TEST(SwarmMetrics, TracksArePureWhenTheyShowOneTarget) {
  std::vector<ObserverFrame> frames;
  for (int k = 0; k < 4; ++k) {
    frames.push_back(SeenFrame(k, TargetAhead(k < 3 ? 1 : 2, 10), 10));
    frames.back().ranges->estimates[0].track_id = 5;
    frames.back().ranges->estimates.push_back(frames.back().ranges->estimates[0]);
  }
  EXPECT_DOUBLE_EQ(*MetricsOf({}, frames).track_purity, 0.75);
  frames.push_back(SeenFrame(9, TargetAhead(1, 10), 10));
  frames.back().detections->boxes[0] = StereoBox(Box(100, 100, 9, 9), Box(50, 100, 9, 9));
  frames.back().ranges->estimates[0].track_id = 6;
  EXPECT_DOUBLE_EQ(*MetricsOf({}, frames).track_purity, 0.8);
}

/// 5 s of aircraft 0 at 2 m/s, 5.5 m before aircraft 1, which stands; the guard acts in the first
/// `n_guarded` of 50 ticks.
RunRecord GuardedFlight(double wish_mps, int n_guarded) {
  RunRecord run = Flight({});
  run.scenario.swarm.guard.enabled = true;
  run.scenario.aircraft.resize(2);
  run.scenario.aircraft[0].self.controller = Controller::kSwarm;
  run.scenario.aircraft[1].self.id = 1;
  for (int k = 0; k < 50; ++k) {
    run.world.push_back(World({Uav(0, 0, 2), Uav(1, 5.5)}, UtimeOfTick(k, 10)));
    for (int id : {0, 1}) {
      velocity_command_t command{};
      command.utime = UtimeOfTick(k, 10);
      command.id = id;
      command.wish_WB_mps[0] = wish_mps;
      command.is_guarded = k < n_guarded ? 1 : 0;
      run.commands.push_back(command);
    }
  }
  return run;
}

// At 2 m/s it needs 5.58 m (tests/eval/braking_test.cc), so all 20 brakes are right and 30 missing;
// at 0.1 m/s none is needed. Aircraft 1 does not fly by the swarm's law.
TEST(SwarmMetrics, BrakesAreFalseWithoutNeedAndMissedWithIt) {
  const auto metrics = [](const RunRecord& run) {
    return ComputeSwarmMetrics(run, SwarmTicks(run));
  };
  const SwarmMetrics needed = metrics(GuardedFlight(2, 20));
  EXPECT_DOUBLE_EQ(*needed.guarded, 0.4);
  EXPECT_DOUBLE_EQ(*needed.false_brakes, 0);
  EXPECT_DOUBLE_EQ(*needed.missed_brakes, 0.6);
  const SwarmMetrics needless = metrics(GuardedFlight(0.1, 20));
  EXPECT_DOUBLE_EQ(*needless.guarded, 0.4);
  EXPECT_DOUBLE_EQ(*needless.false_brakes, 0.4);
  EXPECT_DOUBLE_EQ(*needless.missed_brakes, 0);
  EXPECT_EQ(SwarmTicks(GuardedFlight(2, 20))[3].braking.commands, 1);
  RunRecord unguarded = GuardedFlight(2, 20);
  unguarded.scenario.swarm.guard.enabled = false;
  EXPECT_FALSE(metrics(unguarded).false_brakes);
}

// Two blocks of 2.5 s, guarded in the first alone: 0.8 and 0. Half of the resamples of two blocks
// draw both, so the interval reaches from one to the other.
TEST(SwarmMetrics, MeansOfTicksHaveIntervals) {
  const RunRecord run = GuardedFlight(2, 20);
  const SwarmMetrics metrics = ComputeSwarmMetrics(run, SwarmTicks(run));
  EXPECT_DOUBLE_EQ(metrics.ci95.at("guarded")[0], 0);
  EXPECT_DOUBLE_EQ(metrics.ci95.at("guarded")[1], 0.8);
  EXPECT_EQ(metrics.ci95.count("min_separation_m"), 0u);
  EXPECT_EQ(metrics.ci95.count("connectivity"), 0u) << "no frames";
}

}  // namespace
}  // namespace windhover
