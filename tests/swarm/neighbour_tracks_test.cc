// What becomes of sightings: tracks, the collision guard that brakes for them, where the rig looks.

#include "swarm/neighbour_tracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "common/random/random_stream.h"
#include "swarm/collision_guard.h"
#include "swarm/yaw_policy.h"

namespace windhover {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

nav_state_t NavAt(int tick) {
  nav_state_t nav{};
  nav.utime = tick * 100'000;
  nav.qw = 1;
  return nav;
}

/// A rig at the origin of W with axes of W, so that sightings are what the track should be.
class NeighbourTracksTest : public testing::Test {
 protected:
  static range_estimate_t Estimate(const Vector3d& p_m, int estimator_track = 0) {
    range_estimate_t estimate{};
    estimate.method = "baseline";
    estimate.status = range_estimate_t::STATUS_OK;
    estimate.track_id = estimator_track;
    estimate.range_sigma_m = 0.3;
    std::copy_n(p_m.data(), 3, estimate.p_RT_m);
    return estimate;
  }

  void Look(std::vector<range_estimate_t> estimates) {
    range_t ranges{};
    ranges.n_estimates = static_cast<int>(estimates.size());
    ranges.estimates = std::move(estimates);
    tracks_.Look(NavAt(tick_++), Eigen::Isometry3d::Identity(), ranges);
  }

  std::vector<Neighbour> Known() const { return tracks_.Within(100, NavAt(tick_ - 1)); }

  TracksConfig config_;
  NeighbourTracks tracks_{config_, "baseline", 2};
  int tick_ = 0;
};

// 20 m away to 0.8 m along the line and 0.15° across it: 5.2 cm.
TEST(SightingCovariance, WorkedExample) {
  const Matrix3d covariance_m2 =
      SightingCovariance(Vector3d::UnitY(), 20, 0.8, 0.15 * EIGEN_PI / 180);
  EXPECT_NEAR(std::sqrt(covariance_m2(1, 1)), 0.8, 1e-12);
  EXPECT_NEAR(std::sqrt(covariance_m2(0, 0)), 0.05236, 1e-5);
  EXPECT_NEAR(std::sqrt(covariance_m2(2, 2)), 0.05236, 1e-5);
  EXPECT_EQ(covariance_m2(0, 1), 0);
  // No sigma, and one that no rig has.
  const double unknown_m = std::sqrt(SightingCovariance(Vector3d::UnitY(), 20, 0, 1e-3)(1, 1));
  EXPECT_NEAR(unknown_m, 1, 1e-12);
  EXPECT_NEAR(std::sqrt(SightingCovariance(Vector3d::UnitY(), 20, 1e-9, 1e-3)(1, 1)), 0.2, 1e-12);
}

// Two sightings of 0.3 m a second apart, nothing believed of the speed: v = Δp / Δt to √2 · 0.3.
TEST(TrackFilter, WorkedExample) {
  const Matrix3d covariance_m2 = 0.09 * Matrix3d::Identity();
  TrackFilter filter({{10, 0, 0}, covariance_m2, 0}, 1e3);
  filter.Predict(1, 1e-6);
  const Sighting second{{11, 0, 0}, covariance_m2, 0};
  EXPECT_NEAR(filter.SquaredDistance(second), 1 / (1e6 + 0.18), 1e-9);
  filter.Update(second);
  EXPECT_NEAR(filter.p_WT_m().x(), 11, 1e-6);
  EXPECT_NEAR(filter.v_WT_mps().x(), 1, 1e-6);
  EXPECT_NEAR(filter.PositionCovariance()(0, 0), 0.09, 1e-6);
}

// P_pp + Δt² P_vv + q Δt³ / 3 with q = 1.5² m²/s³: 0.09 + 4 · 0.25 + 2.25 · 8 / 3 after 2 s.
TEST(TrackFilter, SpreadsWhilePredicting) {
  TrackFilter filter({{10, 0, 0}, 0.09 * Matrix3d::Identity(), 0}, 0.5);
  filter.Predict(2, 1.5);
  EXPECT_NEAR(filter.PositionCovariance()(1, 1), 7.09, 1e-12);
  EXPECT_EQ(filter.PositionCovariance()(0, 1), 0);
}

// Errors squared over the covariance that the filter claims: 3 on average in three dimensions. Of
// 200 targets that move as it believes their mean is so to √(2 · 3 / 200) = 0.17.
TEST(TrackFilter, KnowsHowWrongItIs) {
  RandomStream random(7, "targets");
  double sum = 0;
  const Matrix3d covariance_m2 = SightingCovariance(Vector3d::UnitX(), 20, 0.5, 0.01);
  const auto normal = [&] { return Vector3d(random.Normal(), random.Normal(), random.Normal()); };
  const auto seen = [&](const Vector3d& p) {
    const Vector3d error_m = covariance_m2.diagonal().cwiseSqrt().cwiseProduct(normal());
    return Sighting{p + error_m, covariance_m2, 0};
  };
  for (int target = 0; target < 200; ++target) {
    Vector3d p_m(20, 0, 0), v_mps = normal();
    TrackFilter filter(seen(p_m), 1);
    for (int k = 0; k < 300; ++k) {  // In steps of 0.01 s, seen in every tenth.
      v_mps += 0.1 * normal();
      p_m += 0.01 * v_mps;
      if (k % 10 != 9) continue;
      filter.Predict(0.1, 1);
      filter.Update(seen(p_m));
    }
    const Vector3d error_m = filter.p_WT_m() - p_m;
    sum += error_m.dot(filter.PositionCovariance().inverse() * error_m);
  }
  EXPECT_NEAR(sum / 200, 3, 3 * 0.17);
}

TEST_F(NeighbourTracksTest, CountsAfterItsHitsAndIsForgottenAfterItsMemory) {
  Look({Estimate({10, 0, 0})});
  EXPECT_TRUE(Known().empty());
  Look({Estimate({10, 0, 0})});
  ASSERT_EQ(Known().size(), 1U);
  EXPECT_EQ(Known()[0].unseen_s, 0);
  for (int i = 0; i < 10; ++i) Look({});
  ASSERT_EQ(Known().size(), 1U);
  EXPECT_NEAR(Known()[0].unseen_s, 1, 1e-12);
  Look({});
  EXPECT_TRUE(Known().empty());
}

TEST_F(NeighbourTracksTest, WhatIsSeenOnceIsNobody) {
  Look({Estimate({10, 0, 0})});
  Look({});
  Look({});
  Look({Estimate({10, 0, 0})});  // The first is gone: this is a first sighting again.
  EXPECT_TRUE(Known().empty());
}

TEST_F(NeighbourTracksTest, PredictsWhatItMisses) {
  for (int k = 0; k < 30; ++k) Look({Estimate({10 + 0.1 * k, 0, 0})});  // 1 m/s
  const double sigma_m = Known()[0].sigma_m;
  for (int k = 0; k < 8; ++k) Look({});
  // 0.8 m on, as far as 30 sightings of 0.3 m tell the speed.
  EXPECT_NEAR(Known()[0].p_m.x(), 13.7, 0.1);
  EXPECT_NEAR(Known()[0].v_mps.x(), 1, 0.1);
  EXPECT_GT(Known()[0].sigma_m, 1.5 * sigma_m);
}

// The estimator confuses two that pass each other at 3 m: tracks stay with what moves on.
TEST_F(NeighbourTracksTest, SwappedNumbersDoNotSwapTracks) {
  for (int k = 0; k < 40; ++k) {
    const bool swapped = k >= 20;
    Look({Estimate({20, 0.1 * k - 2, 1.5}, swapped ? 1 : 0),
          Estimate({20, 2 - 0.1 * k, -1.5}, swapped ? 0 : 1)});
  }
  const std::vector<Neighbour> known = Known();
  ASSERT_EQ(known.size(), 2U);
  EXPECT_NEAR(known[0].p_m.z(), 1.5, 0.05);
  EXPECT_NEAR(known[0].v_mps.y(), 1, 0.05);
  EXPECT_NEAR(known[1].p_m.z(), -1.5, 0.05);
  EXPECT_NEAR(known[1].v_mps.y(), -1, 0.05);
}

TEST_F(NeighbourTracksTest, OneSightingIsOfOneAircraft) {
  for (int k = 0; k < 10; ++k) Look({Estimate({15, 0, 0}, 0), Estimate({15, 0.6, 0}, 1)});
  ASSERT_EQ(Known().size(), 2U);
  // One of them is missed: its track must not feed on the other's sighting.
  for (int k = 0; k < 5; ++k) Look({Estimate({15, 0, 0}, 0)});
  const std::vector<Neighbour> known = Known();
  ASSERT_EQ(known.size(), 2U);
  EXPECT_EQ(known[0].unseen_s, 0);
  EXPECT_NEAR(known[1].unseen_s, 0.5, 1e-12);
  EXPECT_NEAR(known[1].p_m.y(), 0.6, 0.05);
}

// Two come out of one another: what both could be of a track is of one, the other begins its own.
TEST_F(NeighbourTracksTest, ATrackTakesOneSightingOfAFrame) {
  for (int k = 0; k < 5; ++k) Look({Estimate({15, 0, 0}, 0)});
  for (int k = 0; k < 3; ++k) Look({Estimate({15, 0, 0}, 0), Estimate({15, 0.05, 0}, 0)});
  EXPECT_EQ(Known().size(), 2U);
}

// Beyond four sigmas, and beside the line of sight much sooner: it is somebody else.
TEST_F(NeighbourTracksTest, TheGateIsNarrowAcrossTheLineOfSight) {
  for (int k = 0; k < 20; ++k) Look({Estimate({20, 0, 0})});
  Look({Estimate({20.7, 0, 0})});
  Look({Estimate({20.7, 0, 0})});
  EXPECT_EQ(Known().size(), 1U);
  Look({Estimate({20, 0.7, 0})});
  Look({Estimate({20, 0.7, 0})});
  ASSERT_EQ(Known().size(), 1U) << "the estimator says that it is the same, and the old is unseen";
  EXPECT_NEAR(Known()[0].p_m.y(), 0.7, 0.05);
}

TEST_F(NeighbourTracksTest, TheOrderOfSightingsDoesNotMatter) {
  NeighbourTracks other(config_, "baseline", 2);
  RandomStream random(3, "sightings");
  for (int k = 0; k < 30; ++k) {
    range_t ranges{};
    for (int i = 0; i < 5; ++i) {
      ranges.estimates.push_back(
          Estimate({15 + 2.0 * i, i - 2 + 0.02 * random.Normal(), 0.03 * k * (i % 2)}, i));
    }
    ranges.n_estimates = 5;
    tracks_.Look(NavAt(k), Eigen::Isometry3d::Identity(), ranges);
    if (k > 0)
      std::rotate(ranges.estimates.begin(), ranges.estimates.begin() + k % 5,
                  ranges.estimates.end());
    other.Look(NavAt(k), Eigen::Isometry3d::Identity(), ranges);
  }
  const std::vector<Neighbour> a = tracks_.Within(100, NavAt(29)), b = other.Within(100, NavAt(29));
  ASSERT_EQ(a.size(), 5U);
  ASSERT_EQ(b.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(a[i].p_m, b[i].p_m);
}

TEST_F(NeighbourTracksTest, IgnoresWhatIsNoPlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  range_estimate_t failed = Estimate({10, 0, 0}), other = failed, sigma = failed;
  failed.status = range_estimate_t::STATUS_NO_ESTIMATE;
  other.method = "size";
  for (int k = 0; k < 3; ++k) {
    Look({failed, other, Estimate({nan, 0, 0}), Estimate({1e300, 0, 0}), Estimate({0, 0, 0})});
  }
  EXPECT_TRUE(Known().empty());
  sigma.range_sigma_m = nan;
  for (int k = 0; k < 3; ++k) Look({sigma});
  ASSERT_EQ(Known().size(), 1U);
  EXPECT_TRUE(std::isfinite(Known()[0].sigma_m));
  EXPECT_TRUE(tracks_.Within(5, NavAt(2)).empty());
}

// 10 m to what stands, 0.5 m of sigma, 2.5 m to keep: 6.5 m, at 1.5 m/s² and 1 1/s
// √(2 · 1.5 · 6.5 − 1.5²) = 4.15 m/s. One that comes at 2 m/s takes (4 / 1.5 + 1.5) / 2 = 2.08 m
// of that, one that leaves gives them.
TEST(SafeClosingSpeed, WorkedExample) {
  const GuardConfig config{.enabled = true};
  const Vector3d still = Vector3d::Zero();
  Neighbour ahead{{10, 0, 0}, still, 0.5};
  EXPECT_NEAR(SafeClosingSpeed(config, ahead, still, 5), std::sqrt(19.5 - 2.25), 1e-12);
  ahead.v_mps = {-2, 0, 0};
  // Half a second of closing at 2 m/s goes first.
  const double left_m = 6.5 - 1 - (4 / 1.5 + 1.5) / 2;
  EXPECT_NEAR(SafeClosingSpeed(config, ahead, still, 5), std::sqrt(3 * left_m - 2.25), 1e-12);
  ahead.v_mps = {2, 0, 0};
  const double room_m = 6.5 + (4 / 1.5 + 1.5) / 2;
  EXPECT_NEAR(SafeClosingSpeed(config, ahead, {2, 0, 0}, 5), std::sqrt(3 * room_m - 2.25), 1e-12);
  ahead = {{1.5, 0, 0}, still};  // Inside: back off at 1 1/s.
  EXPECT_NEAR(SafeClosingSpeed(config, ahead, still, 5), -1, 1e-12);
}

TEST(Guarded, ChangesOnlyWhatIsTooFast) {
  const GuardConfig config{.enabled = true};
  const Vector3d still = Vector3d::Zero();
  const std::array near = {Neighbour{{3.5, 0, 0}, still}};  // 1 m left: 1 m/s.
  const GuardedVelocity braked = Guarded(config, near, still, {2, 0.5, 0}, 3);
  EXPECT_TRUE(braked.is_guarded);
  EXPECT_LT((braked.v_mps - Vector3d(1, 0.5, 0)).norm(), 1e-9);
  const GuardedVelocity away = Guarded(config, near, still, {-2, 0.5, 0}, 3);
  EXPECT_FALSE(away.is_guarded);
  EXPECT_EQ(away.v_mps, Vector3d(-2, 0.5, 0));
  EXPECT_FALSE(Guarded({.enabled = false}, near, still, {2, 0.5, 0}, 3).is_guarded);
}

// One that comes at 2 m/s and will pass: 3 m aside it may, 2 m aside not.
TEST(Guarded, LetsPassWhatIsNotInTheWay) {
  const GuardConfig config{.enabled = true};
  const Vector3d wish(2, 0, 0);
  const std::array wide = {Neighbour{{5, 3, 0}, {-2, 0, 0}}};
  const std::array narrow = {Neighbour{{5, 2, 0}, {-2, 0, 0}}};
  EXPECT_FALSE(Guarded(config, wide, wish, wish, 3).is_guarded);
  EXPECT_TRUE(Guarded(config, narrow, wish, wish, 3).is_guarded);
}

// Any law, here the worst: straight at each other, or at one that stands. An aircraft answers to
// commands in 0.4 s, with a lag of 0.1 s.
TEST(Guarded, StopsBeforeTheOther) {
  const GuardConfig config{.enabled = true};
  for (const bool both : {true, false}) {
    for (const double wish_mps : {1.0, 2.0, 4.0}) {
      double x_m[2] = {0, 30}, v_mps[2] = {0, 0}, a_mps2[2] = {0, 0}, least_m = 30;
      for (int k = 0; k < 400; ++k) {  // 0.1 s each.
        double command_mps[2] = {0, 0};
        for (int i = 0; i < (both ? 2 : 1); ++i) {
          const double sign = i == 0 ? 1 : -1;
          const std::array other = {Neighbour{{x_m[1 - i] - x_m[i], 0, 0}, {v_mps[1 - i], 0, 0}}};
          command_mps[i] =
              Guarded(config, other, {v_mps[i], 0, 0}, {sign * wish_mps, 0, 0}, 4).v_mps.x();
        }
        for (int step = 0; step < 100; ++step) {
          for (int i = 0; i < 2; ++i) {
            a_mps2[i] += 0.001 * ((command_mps[i] - v_mps[i]) / 0.4 - a_mps2[i]) / 0.1;
            v_mps[i] += 0.001 * a_mps2[i];
            x_m[i] += 0.001 * v_mps[i];
          }
          least_m = std::min(least_m, x_m[1] - x_m[0]);
        }
      }
      // What the lag may cost; gain times lag is 0.6, which overshoots by a tenth of its last
      // metre.
      EXPECT_GT(least_m, config.stop_m - 0.2) << wish_mps << (both ? " both" : " one");
      EXPECT_LT(x_m[1] - x_m[0], config.stop_m + 0.3);
    }
  }
}

TEST(YawPolicy, LooksWhereItIsTold) {
  SwarmConfig config;
  Eigen::Isometry3d X_WR = Eigen::Isometry3d::Identity();
  X_WR.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // Looks east.
  const std::array<Neighbour, 2> neighbours = {Neighbour{{10, 4, 0}, Vector3d::Zero(), 0, 0},
                                               Neighbour{{5, -10, 0}, Vector3d::Zero(), 0, 0.5}};
  const Vector3d north(0, 1, 0), none = Vector3d::Zero();
  EXPECT_LT(YawRateFor(config, neighbours, north, X_WR), 0);  // The middle is south-east.
  config.yaw = YawPolicy::kVelocity;
  EXPECT_GT(YawRateFor(config, neighbours, north, X_WR), 0);
  EXPECT_EQ(YawRateFor(config, neighbours, none, X_WR), 0.3);
  config.yaw = YawPolicy::kAttend;
  EXPECT_LT(YawRateFor(config, neighbours, north, X_WR), -0.9);  // At the one unseen.
  const std::array<Neighbour, 1> one = {neighbours[0]};
  EXPECT_GT(YawRateFor(config, one, none, X_WR), 0);
  config.yaw = YawPolicy::kScan;
  EXPECT_EQ(YawRateFor(config, neighbours, north, X_WR), 0.3);
}

}  // namespace
}  // namespace windhover
